"""What is seen at an instant of a recording: where everything stands, and what is written over it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from surefoot.config.robot import LEGS
from surefoot.tools.plot.probes import Probe, find_probes
from surefoot.tools.tables.recording_tables import RecordingTables
from surefoot.tools.tables.table import NotRecorded, Table

_POSE = ("p_WB", "quat_WB", "q", "p_WF", "force_W")
_FOLLOW_S = 0.4  # in which the camera comes after the trunk


def frame_times(begin_s: float, end_s: float, fps: float, speed: float) -> np.ndarray:
    """(n,) instants of a film's frames [s]: `speed` seconds of the run for each of the film's."""
    return np.arange(begin_s, end_s + 1e-9, speed / fps)


@dataclass(frozen=True)
class Instant:
    """What one frame shows.

    Attributes:
        t: on the run's clock [s].
        qpos: MuJoCo's; without truth the terrain is as it was built, and only the robot is in it (19,).
        p_WF: (4, 3) foot centres [m], and force_W: (4, 3) what the ground does on them [N].
        leg: whose turn it is; -1 nobody's.
        lookat_W: (3,) what stands in the middle [m].
        lines: (what, value) of what is written over it.
        verdicts: (place (3,), verdict) of the probes until then.
    """

    t: float
    qpos: np.ndarray
    p_WF: np.ndarray
    force_W: np.ndarray
    leg: int
    lookat_W: np.ndarray
    lines: tuple[tuple[str, str], ...]
    verdicts: tuple[tuple[np.ndarray, str], ...]


class Scenes:
    """The instants of a recording, from its truth or, lacking that, from its estimate.

    Attributes:
        true: they show the truth.
    """

    def __init__(self, recording: RecordingTables, t: np.ndarray):
        """For the instants (n,) [s].

        Raises:
            NotRecorded: there is neither truth nor estimate of that time.
        """
        self.true = "sim/truth" in recording
        key, begin, end = "sim/truth" if self.true else "state/estimate", t[0] - 0.1, t[-1]
        self._seen = recording.read(key, (*_POSE, "terrain_q") if self.true else _POSE, begin, end)
        if not self._seen.rows:
            raise NotRecorded(f"{recording.path}: no {key} between {t[0]:g} and {t[-1]:g} s")
        self._reference = _maybe(recording, "fsm/reference", ("state", "leg"), begin, end)
        probes = find_probes(recording) if "fsm/event" in recording else []
        self._verdicts = [(probe.end_t, self._place(probe), probe.verdict) for probe in _judged(probes, t[-1])]
        self._t, self._rows = t, self._seen.at(t)
        self._lookat = _followed(self._seen["p_WB"][self._rows], t)

    def __len__(self) -> int:
        return len(self._t)

    def __iter__(self) -> Iterator[Instant]:
        return (self[number] for number in range(len(self)))

    def __getitem__(self, number: int) -> Instant:
        t, row, seen = float(self._t[number]), self._rows[number], self._seen
        terrain = seen["terrain_q"][row] if self.true else np.zeros(0)
        state, leg = self._machine(t)
        return Instant(
            t=t,
            qpos=np.concatenate([seen["p_WB"][row], seen["quat_WB"][row], seen["q"][row], terrain]),
            p_WF=seen["p_WF"][row],
            force_W=seen["force_W"][row],
            leg=leg,
            lookat_W=self._lookat[number],
            lines=(
                ("time", f"{t:.2f} s"),
                ("state", state or "-"),
                ("leg", LEGS[leg] if leg >= 0 else "-"),
                ("shown", "truth" if self.true else "estimate"),
            ),
            verdicts=tuple((place, verdict) for at, place, verdict in self._verdicts if at <= t),
        )

    def _machine(self, t: float) -> tuple[str, int]:
        if self._reference is None:
            return "", -1
        (row,) = self._reference.at(np.array([t]))
        return str(self._reference["state"][row]), int(self._reference["leg"][row])

    def _place(self, probe: Probe) -> np.ndarray:
        """Where the foot met the ground, in what is shown; where that is not in it, where it was estimated."""
        met_t = probe.end_t if np.isnan(probe.contact_t) else probe.contact_t
        if not self._seen.t[0] <= met_t <= self._seen.t[-1]:
            return probe.p_WF
        (row,) = self._seen.at(np.array([met_t]))
        return self._seen["p_WF"][row, probe.leg]


def _judged(probes: list[Probe], end_s: float) -> list[Probe]:
    return [probe for probe in probes if probe.verdict != "unfinished" and probe.end_t <= end_s]


def _maybe(
    recording: RecordingTables, key: str, fields: tuple[str, ...], begin_s: float, end_s: float
) -> Table | None:
    table = recording.read(key, fields, begin_s, end_s) if key in recording else None
    return table if table is not None and table.rows else None


def _followed(p_WB: np.ndarray, t: np.ndarray) -> np.ndarray:
    """(n, 3) the trunk's way without its sway."""
    followed = np.empty_like(p_WB)
    followed[0] = p_WB[0]
    for row in range(1, len(t)):
        share = 1.0 - np.exp(-(t[row] - t[row - 1]) / _FOLLOW_S)
        followed[row] = followed[row - 1] + share * (p_WB[row] - followed[row - 1])
    return followed
