"""Watches one run on the bus and grades it with the simulator's truth and the press test."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from surefoot.bus.message import Message
from surefoot.bus.messages import (
    FootholdRegions,
    FsmEvent,
    JointCommand,
    LegStatus,
    MotionReference,
    Policy,
    SimTruth,
    StateEstimate,
)
from surefoot.bus.topics import TOPICS
from surefoot.components.fsm.support_triangle import SupportTriangle
from surefoot.config.deployment import Deployment
from surefoot.config.robot import GRAVITY
from surefoot.hw.mujoco.press_test import COLLAPSE_M
from surefoot.hw.mujoco.terrain import Field
from surefoot.tools.evaluation.drops import Drops
from surefoot.tools.evaluation.labels import Labels
from surefoot.tools.evaluation.outcome import BELOW_M, CARRIES_N, Outcome

ENVELOPE_FORCES = 6
_OUT_M = 0.02  # a foot that has been in a hole is out of it once it is less than this below the surface
_TRUTH_DT = 1.0 / TOPICS["sim/truth"].rate_hz


@dataclass
class _Probe:
    """A probe that has begun.

    Attributes:
        point: (2,) where the foot truly stands [m].
        force_n: largest normal force that it is asked for.
        borne: every force has had its dwell.
    """

    point: np.ndarray
    force_n: float
    borne: bool = False


class Grader:
    """Collects the measures of `results.json` while a run goes on.

    Attributes:
        outcome: whether the run is decided, and how.
        counts: what is counted, by its name in `results.json`.
    """

    def __init__(self, deployment: Deployment, field: Field):
        """For a deployment whose terrain lies in `field`."""
        robot = deployment.load_robot()
        self._labels = Labels(deployment)
        self._drops = Drops(field, robot.foot.radius)
        self.outcome = Outcome(deployment.terrain.row, field, robot.foot.radius, self._labels.fails)
        self._truth: SimTruth | None = None
        self._estimate: StateEstimate | None = None
        self._reference: MotionReference | None = None
        self._policy: Policy | None = None
        self._command: JointCommand | None = None
        self._start: SimTruth | None = None
        self._estimate_error = np.zeros(3)
        self._touched_W: dict[int, np.ndarray] = {}
        self._accepted_W: dict[int, np.ndarray] = {}
        self._sunk: set[int] = set()
        self._probe: _Probe | None = None
        # Without a probe the ground has to bear what a standing foot puts on it.
        self._standing_n = robot.mass * GRAVITY / 4
        self._borne_n = 0.0  # largest force asked in this candidate's probes that were borne to their end
        self._certified_n = [self._standing_n] * 4
        self._carried_n = np.zeros(4)  # largest force on each foot since it was accepted
        self._in_hole: set[int] = set()
        self._lifting: tuple[int, float] | None = None
        self._held: list[tuple[float, ...]] = []
        self.counts = dict.fromkeys(
            ("footholds", "probes", "candidates_tried", "collapses_detected", "missed_collapses", "false_alarms"),
            0,
        )
        self.counts |= dict.fromkeys(
            (
                "late_collapses",
                "late_false_alarms",
                "true_positives",
                "false_negatives",
                "in_hole",
                "rejected_by_map",
                "doubtful_alarms",
                "doubtful_misses",
            ),
            0,
        )
        self.edge_distance: list[float] = []
        self.displacement: list[float] = []
        self.unload: list[float] = []
        self.margin = np.inf
        self.tilt = self.saturated_s = self.energy = self.z_error = self.tilt_error = 0.0
        self.probe_force: dict[str, list] = {
            key: [] for key in ("force_index", "asked_n", "mpc_n", "wbc_n", "estimated_n", "true_n")
        }
        self._squares = np.zeros(3)  # of true - MPC, estimate - true, and their count, while forces are held
        self.violation: dict[str, float] = {}

    def __call__(self, key: str, message: Message) -> None:
        """Listen to every message of the run."""
        if isinstance(message, SimTruth):
            self._on_truth(message)
        elif isinstance(message, StateEstimate):
            self._estimate = message
        elif isinstance(message, MotionReference):
            self._reference = message
            self.outcome.on_reference(message)
        elif isinstance(message, Policy) and message.valid:
            self._policy = message
            for name, value in zip(message.constraint, message.violation, strict=True):
                self.violation[name] = max(self.violation.get(name, 0.0), float(value))
        elif isinstance(message, JointCommand):
            self._command = message
        elif isinstance(message, FootholdRegions):
            leg = self._reference.leg if self._reference is not None else -1
            self.counts["rejected_by_map"] += leg >= 0 and not message.safe[leg]
        elif isinstance(message, FsmEvent):
            self._on_event(message)

    # Truth ----------------------------------------------------------------------------------------------

    def _on_truth(self, truth: SimTruth) -> None:
        self._truth = truth
        w = min(1.0, abs(float(truth.quat_WB[0] ** 2 + truth.quat_WB[3] ** 2)))
        tilt = 2.0 * np.arccos(np.sqrt(w))
        self.tilt = max(self.tilt, float(tilt))
        self.energy += _TRUTH_DT * truth.power_w
        self.saturated_s += _TRUTH_DT * truth.saturated
        if self._start is None:
            self._start = truth
        self.outcome.on_truth(truth, float(tilt))
        self._count_holes(truth)
        self._watch_accepted(truth)
        if self._estimate is not None:
            self._compare(truth, self._estimate)
        if self._reference is not None:
            self._watch_probe(truth, self._reference)

    def _count_holes(self, truth: SimTruth) -> None:
        """Feet that go into a hole, on their way to a candidate or where they stand; each time counts."""
        for leg in range(4):
            depth = self.outcome.depth(truth, leg)
            if depth >= BELOW_M and leg not in self._in_hole:
                self._in_hole.add(leg)
                self.counts["in_hole"] += 1
            elif depth < _OUT_M:
                self._in_hole.discard(leg)

    def _watch_accepted(self, truth: SimTruth) -> None:
        self._carried_n = np.maximum(self._carried_n, truth.force_W[:, 2])
        status = self._reference.leg_status if self._reference is not None else np.zeros(4, int)
        for leg, where in self._accepted_W.items():
            if leg in self._sunk or status[leg] not in (LegStatus.STANCE, LegStatus.COLLAPSING):
                continue
            if where[2] - truth.p_WF[leg, 2] > COLLAPSE_M:
                self._sunk.add(leg)
                self.counts["missed_collapses"] += 1

    def _compare(self, truth: SimTruth, estimate: StateEstimate) -> None:
        error = estimate.p_WB - truth.p_WB
        self._estimate_error = error
        self.z_error = max(self.z_error, abs(float(error[2])))
        up, seen = _up(truth.quat_WB), _up(estimate.quat_WB)
        self.tilt_error = max(self.tilt_error, float(np.arccos(np.clip(up @ seen, -1.0, 1.0))))

    def _watch_probe(self, truth: SimTruth, reference: MotionReference) -> None:
        """CoM margin from lift-off to the end of probing; forces while one is held; the unloading."""
        if self._lifting is not None:
            lifted, since = self._lifting
            if truth.force_W[lifted, 2] < CARRIES_N:
                self.unload.append(truth.t - since)
                self._lifting = None
        leg = reference.leg
        if leg < 0:
            return
        busy = reference.leg_status[leg] in (LegStatus.SWING, LegStatus.LANDING, LegStatus.PROBING)
        if busy and reference.state in ("DETECT_CONTACT", "PROBE", "PROBE_AROUND", "LEG_UP"):
            self.margin = min(self.margin, SupportTriangle(truth.p_WF, leg).margin(truth.com_W[:2]))
        if reference.state != "PROBE" or reference.probe_leg < 0:
            return
        since = truth.t - reference.probe_t0
        index, inside = divmod(since, reference.probe_dwell_s)
        if 0 <= index < ENVELOPE_FORCES and inside >= 0.5 * reference.probe_dwell_s:
            self._hold(int(index), truth, reference)

    def _hold(self, index: int, truth: SimTruth, reference: MotionReference) -> None:
        if self._policy is None or self._command is None or self._estimate is None:
            return
        leg, normal = reference.probe_leg, reference.normal_W
        policy = self._policy
        step = min(max(int((truth.t - policy.t) / policy.dt), 0), len(policy.u) - 1)
        planned = float(policy.u[step].reshape(8, 3)[leg] @ normal)
        true, seen = truth.force_W[leg] @ normal, self._estimate.force_W[leg] @ normal
        asked = reference.probe_force_W[index + 1] @ normal
        self._squares += [(true - planned) ** 2, (seen - true) ** 2, 1.0]
        self._held.append((index, asked, planned, self._command.force_W[leg] @ normal, seen, true))

    # Events ---------------------------------------------------------------------------------------------

    def _on_event(self, event: FsmEvent) -> None:
        truth, counts = self._truth, self.counts
        if truth is None:
            return
        leg = event.leg
        if event.kind == "contact":
            self._touched_W[leg] = truth.p_WF[leg].copy()
            self._borne_n *= event.around > 0
        elif event.kind == "transition" and event.state == "PROBE":
            counts["probes"] += 1
            counts["candidates_tried"] += event.around == 0
            self._held.clear()
            self._probe = _Probe(truth.p_WF[leg, :2].copy(), self._largest_asked())
        elif event.kind == "transition":
            self._end_probe()
        elif event.kind == "force_held":
            self._end_force(event.force_index)
            if self._probe is not None and event.force_index == ENVELOPE_FORCES - 1:
                self._probe.borne, self._borne_n = True, max(self._borne_n, self._probe.force_n)
        elif event.kind == "collapse":
            counts["collapses_detected"] += 1
            self.displacement.append(float(np.linalg.norm(truth.p_WF[leg] - self._touched_W[leg])))
            self._lifting = (leg, truth.t)
            self._label_collapse()
        elif event.kind == "late_collapse":
            counts["late_collapses"] += 1
            self._label_late_collapse(leg, truth)
        elif event.kind == "accepted":
            counts["footholds"] += 1
            self._measure_edge(truth.p_WF[leg])
            self._accepted_W[leg] = truth.p_WF[leg].copy()
            self._sunk.discard(leg)
            # The map may have certified the foothold before: then nothing was probed.
            self._certified_n[leg] = self._borne_n or event.held_n or self._standing_n
            self._carried_n[leg] = 0.0

    def _measure_edge(self, p_WF: np.ndarray) -> None:
        distance = self._drops.distance(p_WF)
        if distance is not None:
            self.edge_distance.append(distance)

    def _largest_asked(self) -> float:
        """Largest normal force of the envelope; the entry before it is what was there when the foot touched."""
        reference = self._reference
        if reference is None:
            return 0.0
        return float((reference.probe_force_W[1 : 1 + ENVELOPE_FORCES] @ reference.normal_W).max(initial=0.0))

    def _end_force(self, index: int) -> None:
        rows = [row for row in self._held if row[0] == index]
        if rows:
            self.probe_force["force_index"].append(index)
            for key, value in zip(list(self.probe_force)[1:], np.mean(rows, axis=0)[1:], strict=True):
                self.probe_force[key].append(round(float(value), 2))

    def _label_collapse(self) -> None:
        """A collapse is true where the press test says that the probed point fails the envelope's peak."""
        probe, self._probe = self._probe, None
        if probe is not None:
            truly = self._labels.fails(probe.point, probe.force_n)
            self.counts["true_positives" if truly else "false_alarms"] += 1
            self.counts["doubtful_alarms"] += not truly and self._labels.in_doubt(probe.point, probe.force_n)

    def _end_probe(self) -> None:
        """A probe that ended without a collapse is false where the press test says that the point fails it.

        Only a probe whose forces were all borne has trusted its point: one that was broken off says nothing.
        """
        probe, self._probe = self._probe, None
        if probe is not None and probe.borne:
            missed = self._labels.fails(probe.point, probe.force_n)
            self.counts["false_negatives"] += missed
            self.counts["doubtful_misses"] += missed and self._labels.in_doubt(probe.point, probe.force_n)

    def _label_late_collapse(self, leg: int, truth: SimTruth) -> None:
        """A collapse of a trusted foot is false where it has not sunk and the press test says the ground holds.

        The press is at the place where the foot truly stands when it is given up, not where it was accepted: it
        may have slipped off. It presses with the largest force that the foot has borne there, or was certified
        for: the peak of its probe's envelope.
        """
        pressed_n = max(self._certified_n[leg], self._carried_n[leg])
        if leg not in self._sunk and not self._labels.fails(truth.p_WF[leg, :2], pressed_n):
            self.counts["false_alarms"] += 1
            self.counts["late_false_alarms"] += 1

    # Results --------------------------------------------------------------------------------------------

    def results(self) -> dict:
        """The measures of one run, as they stand in `results.json`.

        `precision` is the share of all collapses called, in probes and later, that the press test bears out;
        `recall` the share of the probed points that fail the press test whose collapse was called. Of the
        alarms and misses that count against them, those in doubt lie where the press test's own verdict changes
        within what place and force of a probe are good for (`Labels.in_doubt`).
        """
        counts, truth, start, outcome = self.counts, self._truth, self._start, self.outcome
        footholds = counts["footholds"]
        found, wrong, lost = counts["true_positives"], counts["false_alarms"], counts["false_negatives"]
        right = found + counts["late_collapses"] - counts["late_false_alarms"]
        distance = float(truth.p_WB[0] - start.p_WB[0]) if truth is not None and start is not None else 0.0
        drift = float(np.hypot(*self._estimate_error[:2])) / abs(distance) if abs(distance) > 0.2 else None
        n = max(self._squares[2], 1.0)
        return {
            "success": not outcome.failure,
            "failure": outcome.failure or None,
            "stop_reason": outcome.reason or None,
            "body_contact": outcome.touching or None,
            "distance_m": distance,
            **counts,
            "candidates_per_foothold": counts["candidates_tried"] / footholds if footholds else None,
            "precision": right / (right + wrong) if right + wrong else None,
            "recall": found / (found + lost) if found + lost else None,
            "displacement_at_detection_m": self.displacement,
            "unload_s": self.unload,
            "edge_distance_m": self.edge_distance,
            "min_support_margin_m": None if np.isinf(self.margin) else float(self.margin),
            "max_tilt_rad": self.tilt,
            "probe_force": self.probe_force,
            "probe_rmse_n": {
                "true_vs_mpc": float(np.sqrt(self._squares[0] / n)),
                "estimate_vs_true": float(np.sqrt(self._squares[1] / n)),
            },
            "estimator": {
                "xy_drift_per_m": drift,
                "z_error_max_m": self.z_error,
                "tilt_error_max_rad": self.tilt_error,
            },
            "mpc_violation_max": self.violation,
            "torque_saturation_s": self.saturated_s,
            "energy_j": self.energy,
        }


def _up(quat: np.ndarray) -> np.ndarray:
    """World's up axis in the trunk, from a quaternion (w, x, y, z)."""
    w, x, y, z = quat
    return np.array([2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)])
