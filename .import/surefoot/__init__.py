"""Surefoot: a quadruped that tests the ground before it trusts it."""

__version__ = "0.1.0"
