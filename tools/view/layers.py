"""The layers of the picture."""

LAYERS = {
    "robot": "robot",
    "terrain": "terrain as simulated",
    "map": "elevation map",
    "loads": "load-bearing layer",
    "footholds": "footholds and verdicts",
    "candidates": "candidates",
    "forces": "forces",
    "envelope": "force envelope",
    "cone": "friction cones",
    "support": "support polygon",
    "com": "centre of mass",
    "swing": "planned swing",
    "horizon": "MPC horizon",
}
"""Layers in the order of the panel, with their names there."""
