"""The robot, real or simulated, behind one interface. Only the `io` component may use it."""
