"""Where the robot is going: the planned swing and the MPC's horizon."""

from __future__ import annotations

import numpy as np

from surefoot.bus.messages import MotionReference, Policy
from surefoot.components.gait.swing_spline import SwingSpline
from surefoot.components.robot_model.rotations import matrices_of_rpy
from surefoot.tools.view.drawing import Drawing, Lines, path
from surefoot.tools.view.palette import HORIZON_BASE, HORIZON_FOOT, SWING
from surefoot.tools.view.robot_shapes import RobotShapes

_SWING_POINTS = 24
_NODES_APART = 3  # of the horizon every so many are enough for a line
_MOVES_M = 0.01  # a foot whose horizon is shorter stands


def draw_swing(reference: MotionReference) -> Drawing:
    """The path of a swing that is planned or under way; nothing once the foot has landed or while none is."""
    if reference.swing_leg < 0 or reference.t >= reference.swing_t1:
        return {}
    spline = SwingSpline(reference)
    points, _, _ = spline.sample(np.linspace(spline.t0, spline.t1, _SWING_POINTS))
    return {"swing/path": Lines(path(points), SWING, 0.005)}


def draw_horizon(policy: Policy, robot: RobotShapes) -> Drawing:
    """The base over the MPC's horizon, and the feet that move in it."""
    x = policy.x[::_NODES_APART]
    if len(x) < 2:
        return {}
    feet_W = robot.feet(x[:, 6:9], matrices_of_rpy(x[:, 9:12]), x[:, 12:24])
    moving = np.ptp(feet_W, axis=0).max(axis=1) > _MOVES_M
    drawing: Drawing = {"horizon/base": Lines(path(x[:, 6:9]), HORIZON_BASE, 0.006)}
    if moving.any():
        segments = np.concatenate([path(feet_W[:, leg]) for leg in np.flatnonzero(moving)])
        drawing = {**drawing, "horizon/feet": Lines(segments, HORIZON_FOOT)}
    return drawing
