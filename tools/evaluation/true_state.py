"""The ideal estimator of the arm `true_state`: what is lost to the estimate, and what is not."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from surefoot.bus.messages import SimTruth, StateEstimate
from surefoot.components.component import Component, Inbox, Outbox
from surefoot.components.estimator.surface_normal import SurfaceNormal
from surefoot.components.robot_model import LegKinematics
from surefoot.components.robot_model.rotation import matrix_of, skew
from surefoot.config.deployment import Deployment

_CONTACT_N = 1.0  # the simulator's contacts are exact: what bears anything stands


class TrueState(Component):
    """Publishes the simulator's truth as if it had been estimated.

    It steps in the estimator's place, in the cycle of the sensors: `sim/truth` becomes visible with `hw/state`.
    No process of a deployment can be this; only the evaluation puts it into a stack.
    """

    name: ClassVar[str] = "estimator"
    inputs: ClassVar[tuple[str, ...]] = ("hw/state", "sim/truth")
    outputs: ClassVar[tuple[str, ...]] = ("state/estimate",)

    def __init__(self, deployment: Deployment):
        super().__init__(deployment)
        self._legs = LegKinematics(deployment.load_robot())
        self._normal = SurfaceNormal(deployment.estimator)
        self._contact_WF = np.zeros((4, 3))
        self._begun = False

    def activate(self, t: float, inbox: Inbox) -> bool:
        return inbox.latest("sim/truth") is not None

    def step(self, t: float, inbox: Inbox, outbox: Outbox) -> None:
        truth: SimTruth = inbox.latest("sim/truth")
        contact = np.linalg.norm(truth.force_W, axis=1) > _CONTACT_N
        if not self._begun:
            contact[:] = True  # the plant has made no step yet: there is no force to be told
        self._begun = True
        self._contact_WF[contact] = truth.p_WF[contact]
        outbox.publish(
            "state/estimate",
            StateEstimate(
                t=t,
                valid=True,
                p_WB=truth.p_WB,
                quat_WB=truth.quat_WB,
                v_WB_W=truth.v_WB_W,
                omega_WB_B=truth.omega_WB_B,
                q=truth.q,
                dq=truth.dq,
                p_WF=truth.p_WF,
                v_WF=self._foot_velocity(truth),
                force_W=truth.force_W,
                contact=contact,
                normal_W=self._normal.update(self._contact_WF),
            ),
        )

    def _foot_velocity(self, truth: SimTruth) -> np.ndarray:
        """(4, 3) velocity of the foot centres in the world [m/s]."""
        q, dq = truth.q.reshape(4, 3), truth.dq.reshape(4, 3)
        rotating_B = self._legs.position(q) @ skew(truth.omega_WB_B).T
        joints_B = (self._legs.jacobian(q) @ dq[..., None])[..., 0]
        return truth.v_WB_W + (rotating_B + joints_B) @ matrix_of(truth.quat_WB).T
