"""Listeners that keep of a run what the figures need; one file of arrays each, and a CSV where it is a series."""
