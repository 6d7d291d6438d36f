"""What can be checked without motion: the wire, the robot at rest, this machine."""
