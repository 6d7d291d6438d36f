"""Forces on the probing foot and the centre of mass over the other three, as time series (Figs. 9 and 10)."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from surefoot.bus.message import Message
from surefoot.bus.messages import JointCommand, MotionReference, Policy, SimTruth, StateEstimate
from surefoot.components.fsm.support_triangle import SupportTriangle
from surefoot.config.deployment import Deployment
from surefoot.tools.picture import SupportMargin
from surefoot.tools.reproduce.recording.recorder import Column

FORCES = ("asked", "mpc", "wbc", "estimated", "true")
"""Asked by the envelope, planned by the MPC, commanded by the whole-body QP, told by eq. (7), exerted in truth."""

_ON_THE_WAY = ("DETECT_CONTACT", "PROBE_AROUND")
_FORCE_DOC = {
    "asked": "force of the envelope that eq. (6) asks for; empty before and after the six forces",
    "mpc": "force of the MPC's policy",
    "wbc": "force the joint torques are meant to cause",
    "estimated": "force by eq. (7) from joint torques",
    "true": "force in the simulator",
}


def asked_force(reference: MotionReference, t: float) -> np.ndarray:
    """(3,) force that eq. (6) asks of the probing foot at time t, in W [N]; NaN outside the dwells."""
    forces, since = reference.probe_force_W, t - reference.probe_t0
    index = int(np.floor(since / max(reference.probe_dwell_s, 1e-6)))
    if reference.probe_leg < 0 or not 0 <= index < len(forces) - 1:
        return np.full(3, np.nan)
    inside = since - index * reference.probe_dwell_s
    share = min(max(inside / max(reference.probe_blend_s, 1e-6), 0.0), 1.0)
    return forces[index] + share * (forces[index + 1] - forces[index])


class ForceSeries:
    """One row a reference of the state machine, from lift-off to the end of each probe.

    What nobody has told stays empty: a robot has no truth. Then feet, centre of mass and margin are estimated.
    """

    columns = (
        Column("t_s", "simulated time [s]"),
        Column("probe", "number of the probe in this run, from 0"),
        Column("leg", "leg that probes: 0 FL, 1 FR, 2 RL, 3 RR"),
        Column("around", "0 the foothold, 1 to 4 the point in front, behind, left, right of it, 5 back on it"),
        Column("pressing", "1 in PROBE, 0 from lift-off to contact"),
        *(
            Column(f"{name}_{axis}_n", f"{_FORCE_DOC[name]}, {axis} in the world [N]")
            for name in FORCES
            for axis in "xyz"
        ),
        *(Column(f"normal_{axis}", f"local surface normal, {axis} in the world") for axis in "xyz"),
        Column("com_x_m", "true centre of mass, or the estimated one, x in the world [m]"),
        Column("com_y_m", "the same, y in the world [m]"),
        *(
            Column(f"{leg}_{axis}_m", f"true centre of foot {leg}, or the estimated one, {axis} in the world [m]")
            for leg in ("FL", "FR", "RL", "RR")
            for axis in "xy"
        ),
        Column("margin_m", "that centre of mass to the nearest edge of the other three feet, positive inside [m]"),
    )

    def __init__(self, deployment: Deployment):
        self._robot = deployment.load_robot()
        self._support: SupportMargin | None = None  # made where there is no truth
        self._truth: SimTruth | None = None
        self._estimate: StateEstimate | None = None
        self._command: JointCommand | None = None
        self._policy: Policy | None = None
        self._probe = -1
        self._state = ""
        self._rows: list[list[float]] = []

    def __call__(self, key: str, message: Message) -> None:
        if isinstance(message, SimTruth):
            self._truth = message
        elif isinstance(message, StateEstimate):
            self._estimate = message
        elif isinstance(message, JointCommand):
            self._command = message
        elif isinstance(message, Policy) and message.valid:
            self._policy = message
        elif isinstance(message, MotionReference):
            self._on_reference(message)

    def _on_reference(self, reference: MotionReference) -> None:
        before, self._state = self._state, reference.state
        if reference.state in _ON_THE_WAY and before != reference.state:
            self._probe += 1
        leg = reference.leg
        if leg < 0 or reference.state not in (*_ON_THE_WAY, "PROBE"):
            return
        seen = self._truth or self._estimate
        if seen is None:
            return
        com_W = self._com(seen)
        self._rows.append(
            [seen.t, self._probe, leg, reference.around, reference.state == "PROBE"]
            + [float(value) for force in self._forces(reference, seen.t) for value in force]
            + [*reference.normal_W.tolist(), *com_W[:2].tolist(), *seen.p_WF[:, :2].ravel().tolist()]
            + [SupportTriangle(seen.p_WF, leg).margin(com_W[:2])]
        )

    def _forces(self, reference: MotionReference, t: float) -> Iterator[np.ndarray]:
        """(3,) of each of `FORCES` on the leg that probes; NaN where it was not told."""
        leg, policy, untold = reference.leg, self._policy, np.full(3, np.nan)
        yield asked_force(reference, t)
        if policy is None:
            yield untold
        else:
            step = min(max(int((t - policy.t) / policy.dt), 0), len(policy.u) - 1)
            yield policy.u[step].reshape(8, 3)[leg]
        for told in (self._command, self._estimate, self._truth):
            yield untold if told is None else told.force_W[leg]

    def _com(self, seen: SimTruth | StateEstimate) -> np.ndarray:
        if isinstance(seen, SimTruth):
            return seen.com_W
        if self._support is None:
            self._support = SupportMargin(self._robot)
        return self._support.com(seen.p_WB, seen.quat_WB, seen.q)

    def arrays(self) -> dict[str, np.ndarray]:
        """(n,) t, probe, leg, around, pressing, margin_m; (n, 3) forces, normal_W; (n, 2) com_W; (n, 4, 2) p_WF"""
        table = np.array(self._rows).reshape(-1, len(self.columns))
        found = {
            "t": table[:, 0],
            "probe": table[:, 1].astype(int),
            "leg": table[:, 2].astype(int),
            "around": table[:, 3].astype(int),
            "pressing": table[:, 4].astype(bool),
            "normal_W": table[:, 20:23],
            "com_W": table[:, 23:25],
            "p_WF": table[:, 25:33].reshape(-1, 4, 2),
            "margin_m": table[:, 33],
        }
        return found | {name: table[:, 5 + 3 * i : 8 + 3 * i] for i, name in enumerate(FORCES)}

    def rows(self) -> list[list[float | str]]:
        return [
            ["" if np.isnan(value) else int(value) if 1 <= i <= 4 else float(value) for i, value in enumerate(row)]
            for row in self._rows
        ]
