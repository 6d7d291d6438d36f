"""Where things stand in a state x, and in the columns (u, x, 1) of a stage's matrices.

State x, as a tangent of 24: normalised momentum h/m (linear, angular about the centre of mass, in W), base
position in W, base rotation R exp(phi), joints. Inputs u: three numbers a leg.
"""

from __future__ import annotations

import numpy as np

NX, NU, NV = 24, 12, 18
WIDTH = NU + NX + 1
"""Columns of (u, x, 1)."""

MOMENTUM, POSITION, ROTATION, JOINTS = slice(0, 6), slice(6, 9), slice(9, 12), slice(12, 24)
"""In x."""

U, X, ONE = slice(0, 12), slice(12, 36), 36
U_MOMENTUM, U_POSITION, U_ROTATION, U_JOINTS = slice(12, 18), slice(18, 21), slice(21, 24), slice(24, 36)
CONFIGURATION = slice(18, 36)
"""In (u, x, 1); the configuration is (position, rotation, joints), what the places of things depend on."""


def leg_blocks(matrices: np.ndarray) -> np.ndarray:
    """The four 3x3 blocks on the diagonal of (N, 12, 12) matrices: a writable view (N, 4, 3, 3)."""
    return np.einsum("nlilj->nlij", matrices.reshape(len(matrices), 4, 3, 4, 3))


def diagonals(matrices: np.ndarray) -> np.ndarray:
    """The diagonals of (N, n, n) matrices: a writable view (N, n)."""
    return np.einsum("nii->ni", matrices)
