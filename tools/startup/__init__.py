"""The guided start-up of a robot, for a person at a terminal; it knows of the stack what is on the bus."""
