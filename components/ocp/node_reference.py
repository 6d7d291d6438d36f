"""What the optimal control problem is asked to follow, at every node."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass
class NodeReference:
    """References and activations at N+1 nodes (inputs use the first N).

    Attributes:
        t: (N+1,) [s]; dt: interval [s].
        contact: (N+1, 4) legs that stand.
        p_WB: (N+1, 3) base [m]; R_WB: (N+1, 3, 3).
        q: (N+1, 4, 3) joints by inverse kinematics [rad].
        p_WF: (N+1, 4, 3) [m], v_WF: (N+1, 4, 3) feet [m/s].
        force_W: (N+1, 4, 3) [N].
        force_max_n: (N+1, 4) largest normal force that each foothold is to bear [N]; infinite: the robot's limit.
        normal_W: (3,) surface normal.
        support_leg: (N+1,) leg left out of the polygon of eq. (5), -1 where it is off.
        support_margin_m: alpha of eq. (5).
        probe_leg: (N+1,) leg of eq. (6), -1 where it is off; probe_force_W: (N+1, 3) [N].
        region_a: (4, 4, 3), region_b: (4, 4) half-spaces of eq. (4); region_active: (N+1, 4).
    """

    t: np.ndarray
    dt: float
    contact: np.ndarray
    p_WB: np.ndarray
    R_WB: np.ndarray
    q: np.ndarray
    p_WF: np.ndarray
    v_WF: np.ndarray
    force_W: np.ndarray
    force_max_n: np.ndarray
    normal_W: np.ndarray
    support_leg: np.ndarray
    support_margin_m: float
    probe_leg: np.ndarray
    probe_force_W: np.ndarray
    region_a: np.ndarray
    region_b: np.ndarray
    region_active: np.ndarray
