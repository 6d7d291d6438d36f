"""Deployments, robots and their typed schema. Imports nothing else of Surefoot; everybody may read it."""
