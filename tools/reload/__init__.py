"""Restarting what is made of source files that have changed."""
