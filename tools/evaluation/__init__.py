"""Grading of the whole stack in lockstep against the simulator's truth."""
