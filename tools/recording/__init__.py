"""Recordings made, looked into, cut and replayed."""
