"""Where a foot may go: answers foothold requests with safe regions, eq. (4). Only the bus talks to it."""
