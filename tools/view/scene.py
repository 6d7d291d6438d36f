"""The whole picture of an instant, layer by layer."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from surefoot.bus.messages import ElevationGrid, MotionReference, StateEstimate
from surefoot.components.fsm.support_triangle import SupportTriangle
from surefoot.config.deployment import Deployment
from surefoot.tools.view.drawing import Drawing
from surefoot.tools.view.footholds import draw_candidates, draw_footholds
from surefoot.tools.view.forces import draw_cones, draw_envelope, draw_forces
from surefoot.tools.view.heard import Heard
from surefoot.tools.view.history import History
from surefoot.tools.view.map_tiles import draw_map
from surefoot.tools.view.plans import draw_horizon, draw_swing
from surefoot.tools.view.robot_shapes import RobotShapes
from surefoot.tools.view.support import Support
from surefoot.tools.view.terrain_shapes import TerrainShapes

_STALE_S = 0.3  # what is older belongs to no picture of now


class Scene:
    """Makes a drawing of what is heard; what has not been heard is not drawn.

    Attributes:
        robot: its links.
    """

    def __init__(self, deployment: Deployment):
        """For the robot and the terrain of a deployment."""
        robot = deployment.load_robot()
        self.robot = RobotShapes(robot)
        simulated = deployment.hw.backend == "mujoco"  # of a real ground nobody knows more than the map
        self._terrain = TerrainShapes(deployment) if simulated else None
        self._foot_radius_m = robot.foot.radius
        self._friction, self._margin_m = deployment.ocp.friction, deployment.fsm.margin_m
        self._com: tuple[StateEstimate, np.ndarray] | None = None
        self._support: Support | None = None
        self._told: tuple = ()
        self._tried: Drawing = {}
        self._grid: ElevationGrid | None = None
        self._map: Drawing = {}

    def draw(self, heard: Heard, hidden: Collection[str] = ()) -> Drawing:
        """All items of an instant but those of the hidden layers; what cannot have changed is the same object."""
        drawing = self._ground(heard)
        drawing |= self._state(heard)
        drawing |= self._intentions(heard)
        return {name: item for name, item in drawing.items() if name.partition("/")[0] not in hidden}

    def focus(self, heard: Heard) -> np.ndarray | None:
        """(3,) what the camera goes along with [m]; None while it is not known."""
        return None if heard.estimate is None else heard.estimate.p_WB * [1.0, 1.0, 0.0]

    def margin_m(self, heard: Heard) -> float | None:
        """How far inside the feet that carry the centre of mass is [m]; None while no leg is moved or probed."""
        estimate, reference = heard.estimate, heard.reference
        if estimate is None or reference is None or reference.leg < 0 or not _stands(reference.p_WF):
            return None
        return SupportTriangle(reference.p_WF, reference.leg).margin(self._com_W(estimate)[:2])

    def _ground(self, heard: Heard) -> Drawing:
        if heard.grid is not self._grid:
            self._grid = heard.grid
            self._map = {} if heard.grid is None else draw_map(heard.grid)
        terrain = self._terrain.draw(heard.truth) if self._terrain is not None else {}
        return terrain | self._map

    def _state(self, heard: Heard) -> Drawing:
        """The robot as it is estimated, and the forces on its feet."""
        estimate, reference = heard.estimate, heard.reference
        if estimate is None:
            return {}
        status = np.zeros(4, int) if reference is None else reference.leg_status
        pose = estimate.p_WB, estimate.quat_WB, estimate.q
        fresh = heard.command is not None and abs(heard.t - heard.command.t) < _STALE_S
        drawing = self.robot.draw(*pose, status) | draw_forces(estimate, heard.command if fresh else None)
        drawing |= draw_cones(
            estimate.p_WF[estimate.contact], estimate.normal_W, self._friction, self._foot_radius_m
        )
        if reference is not None and _stands(reference.p_WF):
            margin_m = reference.support_margin_m or self._margin_m
            if self._support is None or not self._support.holds(reference, margin_m):
                self._support = Support(reference, self._foot_radius_m, margin_m)
            drawing |= self._support.draw(self._com_W(estimate))
        return drawing

    def _intentions(self, heard: Heard) -> Drawing:
        """What the state machine and the planners mean to do, and what has come of it."""
        history, reference = heard.history, heard.reference
        drawing: Drawing = {}
        if reference is not None and _stands(reference.p_WF):
            drawing |= draw_swing(reference)
            drawing |= self._places(history, reference)
            if reference.leg >= 0 and heard.estimate is not None and history.plan is not None:
                drawing |= draw_envelope(history.plan, heard.estimate.p_WF[reference.leg])
        if heard.policy is not None and abs(heard.t - heard.policy.t) < _STALE_S:
            drawing |= draw_horizon(heard.policy, self.robot)
        return drawing

    def _places(self, history: History, reference: MotionReference) -> Drawing:
        """Footholds and candidates; the very same objects while nothing is told and no foot moves on."""
        told = history, history.count, reference.leg, reference.p_WF.tobytes()
        if told != self._told:
            self._told = told
            self._tried = draw_footholds(history, reference, self._foot_radius_m)
            if reference.leg == history.leg >= 0:
                self._tried |= draw_candidates(history, self._foot_radius_m)
        return self._tried

    def _com_W(self, estimate: StateEstimate) -> np.ndarray:
        """(3,) centre of mass [m]."""
        if self._com is None or self._com[0] is not estimate:
            self._com = estimate, self.robot.com(estimate.p_WB, estimate.quat_WB, estimate.q)
        return self._com[1]


def _stands(p_WF: np.ndarray) -> bool:
    """Whether the reference has footholds: a robot that has never stood has none."""
    return bool(np.ptp(p_WF[:, 0]) > 0.0)
