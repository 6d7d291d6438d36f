"""The one process that touches the robot or its simulator."""
