"""The real Aliengo: its low-level packets as pure functions, and the driver that exchanges them over UDP."""
