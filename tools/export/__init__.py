"""A recording, and the robot it is of, in the formats of other programs."""
