"""The one place where the vendor's order of legs meets ours.

The vendor counts FR, FL, RR, RL, and hip, thigh, calf within a leg. Zeros and signs are those of its robot
description, and so are those of `config/robots/aliengo.toml`: hips turn about +x, thighs and calves about +y on
all four legs. No sign changes.
"""

from __future__ import annotations

import numpy as np

from surefoot.config.robot import JOINTS, LEGS

VENDOR_LEGS = ("FR", "FL", "RR", "RL")

VENDOR_JOINTS = tuple(f"{leg}_{joint}" for leg in VENDOR_LEGS for joint in JOINTS)

_LEG = np.array([VENDOR_LEGS.index(leg) for leg in LEGS])
_JOINT = (len(JOINTS) * _LEG[:, None] + np.arange(len(JOINTS))).ravel()


def swap_joints(values: np.ndarray) -> np.ndarray:
    """(12,) figures from the vendor's order to ours or from ours to the vendor's: left and right change places."""
    return values[_JOINT]


def swap_legs(values: np.ndarray) -> np.ndarray:
    """(4,) figures from the vendor's order of legs to ours or back."""
    return values[_LEG]
