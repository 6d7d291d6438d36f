"""Instants of a run, with all the simulator needs to show them again (Figs. 8 and 12)."""

from __future__ import annotations

import numpy as np

from surefoot.bus.message import Message
from surefoot.bus.messages import FsmEvent, MotionReference, SimTruth
from surefoot.config.deployment import Deployment
from surefoot.tools.reproduce.recording.recorder import Column

TICK_S = 5.0
"""Between the instants that are kept whatever happens."""

LEG_UP_AFTER_S = 0.35
"""From a collapse until the foot is up: the state machine's leg_up_s, and a little."""

_EVENTS = ("collapse", "late_collapse", "accepted", "rejected", "stopped")


def joint_positions(truth: SimTruth) -> np.ndarray:
    """(19 + n,) MuJoCo's qpos: trunk position and quaternion, joints, moving terrain."""
    return np.concatenate([truth.p_WB, truth.quat_WB, truth.q, truth.terrain_q])


class Instants:
    """Every verdict on a foothold, the leg up after a collapse, every fifth second, and the end."""

    columns = (
        Column("t_s", "simulated time [s]"),
        Column("kind", "collapse, late_collapse, accepted, rejected, stopped; leg_up after a collapse; tick; end"),
        Column("leg", "0 FL, 1 FR, 2 RL, 3 RR; -1 none"),
        Column("candidate", "0 the planned foothold, 1 to 3 the alternatives"),
        Column("around", "0 the foothold, 1 to 4 the point in front, behind, left, right of it, 5 back on it"),
        Column("foot_x_m", "true centre of that foot, x in the world [m]; of the trunk where there is none"),
        Column("foot_y_m", "the same, y [m]"),
        Column("foot_z_m", "the same, z [m]"),
        Column("displacement_m", "of the foot since its contact, as the state machine saw it [m]"),
        Column("trunk_x_m", "true trunk origin, x in the world [m]"),
    )

    def __init__(self, deployment: Deployment):
        self._truth: SimTruth | None = None
        self._reference: MotionReference | None = None
        self._up: list[tuple[float, FsmEvent]] = []
        self._ticked = -np.inf
        self._rows: list[list[float | str]] = []
        self._qpos: list[np.ndarray] = []

    def __call__(self, key: str, message: Message) -> None:
        if isinstance(message, SimTruth):
            self._on_truth(message)
        elif isinstance(message, FsmEvent) and message.kind in _EVENTS:
            self._note(message.kind, message)
            if message.kind == "collapse" and self._truth is not None:
                self._up.append((self._truth.t + LEG_UP_AFTER_S, message))

    def _on_truth(self, truth: SimTruth) -> None:
        self._truth = truth
        while self._up and truth.t >= self._up[0][0]:
            self._note("leg_up", self._up.pop(0)[1])
        if truth.t - self._ticked >= TICK_S:
            self._ticked = truth.t
            self._note("tick")

    def _note(self, kind: str, event: FsmEvent | None = None) -> None:
        truth = self._truth
        if truth is None:
            return
        leg = event.leg if event is not None else -1
        where = truth.p_WF[leg] if leg >= 0 else truth.p_WB
        told = (event.candidate, event.around) if event is not None else (0, 0)
        moved = event.displacement_m if event is not None else 0.0
        self._rows.append([truth.t, kind, leg, *told, *where.tolist(), moved, float(truth.p_WB[0])])
        self._qpos.append(joint_positions(truth))

    def arrays(self) -> dict[str, np.ndarray]:
        """t, kind, leg, candidate, around, displacement_m, trunk_x_m (n,); foot_W (n, 3); qpos (n, 19 + m)."""
        self._end()
        names = ("t", "kind", "leg", "candidate", "around", "displacement_m", "trunk_x_m")
        places = (0, 1, 2, 3, 4, 8, 9)
        found = {name: np.array([row[i] for row in self._rows]) for name, i in zip(names, places, strict=True)}
        found["foot_W"] = np.array([row[5:8] for row in self._rows], float).reshape(-1, 3)
        return found | {"qpos": np.array(self._qpos)}

    def rows(self) -> list[list[float | str]]:
        self._end()
        return self._rows

    def _end(self) -> None:
        if not self._rows or self._rows[-1][1] != "end":
            self._note("end")
