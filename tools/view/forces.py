"""Forces as arrows, the stride's envelope of them, and the friction cones they must lie in."""

from __future__ import annotations

import numpy as np

from surefoot.bus.messages import JointCommand, MotionReference, Plan, StateEstimate
from surefoot.tools.view.drawing import Arrows, Drawing, Shapes, colours, rows
from surefoot.tools.view.palette import ASKED, CONE, CONE_M, ENVELOPE, FORCE_M_PER_N, MEASURED

_LEAST_N = 3.0  # a shorter arrow is only its head
_BESIDE_M = 0.012  # asked and measured stand side by side


def draw_forces(estimate: StateEstimate, command: JointCommand | None) -> Drawing:
    """Ground reactions at the feet: measured by eq. (7), and what the joint torques are meant to cause."""
    drawing: Drawing = {"forces/measured": _arrows(estimate.p_WF, estimate.force_W, MEASURED, -_BESIDE_M)}
    if command is not None:
        drawing = {**drawing, "forces/asked": _arrows(estimate.p_WF, command.force_W, ASKED, _BESIDE_M)}
    return drawing


def asked_n(reference: MotionReference) -> float | None:
    """Normal force that the probing leg is to press with now [N]; None while it does not press."""
    if not 0 <= reference.force_index < len(reference.probe_force_W) - 1:
        return None
    return float(reference.probe_force_W[reference.force_index + 1] @ reference.normal_W)


def draw_envelope(plan: Plan, foot_W: np.ndarray) -> Drawing:
    """The six extreme forces of the stride on its probing foot (3,)."""
    return {"envelope/forces": _arrows(np.tile(foot_W, (6, 1)), plan.envelope_W, ENVELOPE, 0.0, 0.003)}


def draw_cones(p_WF: np.ndarray, normal_W: np.ndarray, friction: float, foot_radius_m: float) -> Drawing:
    """A friction cone, eq. (3), on each of some feet (n, 3) on ground with a normal (3,)."""
    n = len(p_WF)
    half = 0.5 * np.arctan2(np.hypot(*normal_W[:2]), normal_W[2])
    across = np.array([-normal_W[1], normal_W[0]]) / max(np.hypot(*normal_W[:2]), 1e-9)
    quat = np.array([np.cos(half), *(np.sin(half) * across), 0.0])
    width = 2.0 * friction * CONE_M
    tips = p_WF - foot_radius_m * normal_W
    size = rows((width, width, CONE_M), n)
    return {"cone/feet": Shapes("cone", tips, np.tile(quat, (n, 1)), size, colours(CONE, n), 0.3)}


def _arrows(p_W: np.ndarray, force_W: np.ndarray, rgb, beside_m: float, radius_m: float = 0.006) -> Arrows:
    """Forces (n, 3) at points (n, 3); those of hardly anything are left out."""
    seen = np.linalg.norm(force_W, axis=1) > _LEAST_N
    tails = p_W[seen] + [beside_m, 0.0, 0.0]
    return Arrows(np.stack([tails, tails + FORCE_M_PER_N * force_W[seen]], axis=1), rgb, radius_m)
