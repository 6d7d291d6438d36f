"""Grades of hand-made runs: every measure from messages whose right answer is known."""

from dataclasses import replace

import numpy as np
import pytest

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
from surefoot.components.robot_model import LegKinematics
from surefoot.config.deployment import Deployment
from surefoot.config.robot import load_robot
from surefoot.config.terrain import Planks, Terrain
from surefoot.hw.mujoco.terrain import Field
from surefoot.tools.evaluation.grader import Grader
from surefoot.tools.evaluation.outcome import Outcome

ROBOT = load_robot("aliengo")
FLAT, ON_PLANKS = Deployment(), Deployment(terrain=Terrain(kind="planks"))
UP = np.array([0.0, 0.0, 1.0])
HEIGHT = 0.4
FEET = HEIGHT * UP + LegKinematics(ROBOT).position(np.tile(ROBOT.nominal.stand_q, (4, 1)))
FEET[:, 2] = ROBOT.foot.radius
END_X = 1.0
FIELD = Field(0.0, END_X)
DT = 0.002  # of the truth [s]
ENVELOPE = (40.0, 60.0, 70.0, 80.0, 90.0, 100.0)
DWELL_S = 0.1

PLANKS = Planks()
HINGE_X = ROBOT.legs["FL"].hip_p_B[0] + ROBOT.foot.radius + PLANKS.start_offset_m + PLANKS.beam_width_m
BOARD_Y = 0.5 * (PLANKS.gap_m + PLANKS.board_width_m)
GOOD = (HINGE_X - 0.02, BOARD_Y)  # on a beam
BAD = (HINGE_X + 0.16, BOARD_Y)  # at a board's free end
WEAK = (HINGE_X + 0.09, BOARD_Y)  # sinks 15 mm at 40 N, 42 mm at 120 N


def turned(angle, axis):
    """Quaternion (w, x, y, z) of a turn about an axis of the world."""
    return np.array([np.cos(0.5 * angle), *(np.sin(0.5 * angle) * np.eye(3)[axis])])


class Told:
    """A grader, and the messages it is told one after the other; what is not given stays as it was."""

    def __init__(self, deployment=FLAT, field=FIELD):
        self.grader = Grader(deployment, field)
        self.t = 0.0
        level = np.array([1.0, 0.0, 0.0, 0.0])
        quarter = np.tile(60.0 * UP, (4, 1))
        base = HEIGHT * UP
        self.true = SimTruth(p_WB=base, quat_WB=level, com_W=base, p_WF=FEET, force_W=quarter)
        self.estimated = StateEstimate(p_WB=base, quat_WB=level, force_W=quarter)
        self.asked = MotionReference(state="PRE_OPT", normal_W=UP, p_WF=FEET)

    def truth(self, after=DT, **figures):
        self.t += after
        self.true = replace(self.true, t=self.t, **figures)
        self.grader("sim/truth", self.true)

    def estimate(self, **figures):
        self.estimated = replace(self.estimated, t=self.t, **figures)
        self.grader("state/estimate", self.estimated)

    def reference(self, **figures):
        self.asked = replace(self.asked, t=self.t, **figures)
        self.grader("fsm/reference", self.asked)

    def event(self, kind, leg=0, **figures):
        self.grader("fsm/event", FsmEvent(t=self.t, kind=kind, leg=leg, **figures))

    def foot(self, leg, place, **figures):
        """A foot moves to (x, y) or (x, y, z)."""
        feet = self.true.p_WF.copy()
        feet[leg, : len(place)] = place
        self.truth(p_WF=feet, **figures)

    def status(self, leg, status, state, **figures):
        statuses = np.zeros(4, int)
        statuses[leg] = status
        self.reference(state=state, leg=leg, leg_status=statuses, **figures)

    def probe(self, leg, point, forces=6, envelope=ENVELOPE, around=0):
        """A foot touches, and bears the first `forces` of the envelope."""
        self.foot(leg, point)
        self.event("contact", leg, around=around)
        asked = np.outer([130.0, *envelope, 12.0], UP)  # the touch-down itself may be the largest force
        begin = {"probe_t0": self.t + 0.12, "probe_dwell_s": DWELL_S}
        self.status(leg, LegStatus.PROBING, "PROBE", probe_leg=leg, probe_force_W=asked, **begin)
        self.event("transition", leg, state="PROBE", around=around)
        for index in range(forces):
            self.event("force_held", leg, force_index=index, asked_n=envelope[index])

    def accept(self, leg, **figures):
        self.status(leg, LegStatus.STANCE, "PRE_OPT", probe_leg=-1)
        self.event("accepted", leg, **figures)
        self.event("transition", leg, state="PRE_OPT")

    def collapse(self, leg):
        self.status(leg, LegStatus.SWING, "LEG_UP", probe_leg=-1)
        self.event("collapse", leg)
        self.event("transition", leg, state="LEG_UP")

    @property
    def counts(self):
        return self.grader.counts

    @property
    def results(self):
        return self.grader.results()


# Failures -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("axis", [0, 1])
def test_a_tilt_of_45_degrees_is_a_fall(axis):
    told = Told()
    told.truth(quat_WB=turned(np.deg2rad(44.0), axis))
    assert told.grader.outcome.failure == "" and not told.grader.outcome.over
    told.truth(quat_WB=turned(np.deg2rad(-46.0), axis))
    assert told.grader.outcome.failure == "fell" and told.grader.outcome.over
    assert told.results["max_tilt_rad"] == pytest.approx(np.deg2rad(46.0))


def test_turning_on_the_spot_is_not_a_tilt():
    told = Told()
    told.truth(quat_WB=turned(2.0, 2))
    assert told.grader.outcome.failure == "" and told.results["max_tilt_rad"] < 1e-6


@pytest.mark.parametrize("part", ["trunk", "FL_calf RR_hip", "RL_thigh"])
def test_what_may_not_touch_is_a_failure_and_is_named(part):
    told = Told()
    told.truth(body_contact=part)
    told.truth(quat_WB=turned(1.0, 0), body_contact="")
    assert told.results["failure"] == "contact" and told.results["body_contact"] == part


def test_a_calf_may_touch():
    told = Told()
    told.truth(body_contact="FL_calf")
    assert told.results["success"] and told.results["body_contact"] is None


def test_a_foot_five_seconds_below_the_surface_is_stuck():
    told = Told()
    for z, seconds in ((-0.05, 20.0), (-0.07, 4.9), (0.02, 0.1), (-0.07, 4.9)):
        told.foot(3, (0.0, 0.0, z))
        told.truth(after=seconds)
    assert told.grader.outcome.failure == ""
    told.truth(after=0.2)
    assert told.grader.outcome.failure == "stuck"


def test_the_first_failure_stands():
    told = Told()
    told.truth(quat_WB=turned(1.0, 0))
    told.truth(quat_WB=turned(0.0, 0), body_contact="trunk")
    told.grader.outcome.finish(told.t, told.t)
    assert told.results["failure"] == "fell" and not told.results["success"]


# Ends ---------------------------------------------------------------------------------------------------


def test_the_terrain_is_crossed_when_four_feet_stand_beyond_it():
    told = Told(ON_PLANKS)
    beyond = FEET + [END_X + ROBOT.foot.radius - FEET[:, 0].min() + 1e-3, 0.0, 0.0]
    one_short = beyond.copy()
    one_short[2, 0] = END_X
    told.truth(p_WF=one_short)
    told.truth(p_WF=beyond - [2e-3, 0.0, 0.0])  # the foot's own radius is still on it
    assert not told.grader.outcome.passed
    told.truth(p_WF=beyond, force_W=np.outer([60.0, 60.0, 60.0, 5.0], UP))
    assert not told.grader.outcome.passed
    told.truth(force_W=np.tile(60.0 * UP, (4, 1)))
    assert told.grader.outcome.passed and told.grader.outcome.over
    told.grader.outcome.finish(told.t, 1200.0)
    assert told.results["success"] and told.results["failure"] is None


def test_on_flat_ground_the_whole_walk_is_graded():
    told = Told()
    told.truth(p_WF=FEET + [5.0, 0.0, 0.0])
    told.reference()
    assert told.grader.outcome.passed and not told.grader.outcome.over
    told.reference(state="STOPPED", finished=True)
    assert told.grader.outcome.over


@pytest.mark.parametrize(
    ("deployment", "finished", "t", "failure"),
    [
        (FLAT, True, 99.0, None),
        (FLAT, False, 99.0, "stopped"),
        (FLAT, False, 100.0, "timeout"),
        (ON_PLANKS, True, 99.0, "stopped"),
        (ON_PLANKS, False, 100.0, "timeout"),
    ],
)
def test_a_run_that_ends_short_says_why(deployment, finished, t, failure):
    told = Told(deployment)
    told.truth()
    told.reference(state="STOPPED", finished=finished)
    told.grader.outcome.finish(t, 100.0)
    assert told.results["failure"] == failure and told.results["success"] == (failure is None)


@pytest.mark.parametrize("interval_s", [0.004, 0.02])
def test_a_machine_that_rests_three_seconds_has_stopped(interval_s):
    told = Told()

    def rest(seconds):
        for _ in range(round(seconds / interval_s)):
            told.t += interval_s
            told.reference(state="STOPPED")

    rest(2.9)
    told.reference(state="PRE_OPT")
    rest(2.9)
    assert not told.grader.outcome.over
    rest(0.2)
    assert told.grader.outcome.over


# Footholds ----------------------------------------------------------------------------------------------


def test_an_accepted_foot_that_sinks_is_one_missed_collapse():
    told = Told()
    told.probe(1, FEET[1, :2])
    told.accept(1)
    z = FEET[1, 2]
    told.foot(1, (*FEET[1, :2], z - 0.029))
    assert told.counts["missed_collapses"] == 0
    for depth in (0.031, 0.05, 0.02, 0.04):
        told.foot(1, (*FEET[1, :2], z - depth))
    assert told.counts["missed_collapses"] == 1
    # A new foothold of the same leg may sink as well; in the air a leg does not.
    told.foot(1, (*FEET[1, :2], z))
    told.accept(1)
    told.status(1, LegStatus.SWING, "DETECT_CONTACT")
    told.foot(1, (*FEET[1, :2], z - 0.1))
    assert told.counts["missed_collapses"] == 1
    told.status(1, LegStatus.STANCE, "PRE_OPT")
    told.truth()
    assert told.counts["missed_collapses"] == 2 and told.counts["footholds"] == 2


def test_displacement_at_detection_is_from_where_the_foot_touched():
    told = Told()
    told.probe(0, (0.3, 0.1, 0.02), forces=2)
    told.foot(0, (0.31, 0.08, 0.0))
    told.collapse(0)
    assert told.results["displacement_at_detection_m"] == [pytest.approx(0.03)]
    assert told.counts["collapses_detected"] == 1 and told.counts["probes"] == 1


def test_unloading_ends_when_the_foot_carries_nothing():
    told = Told()
    told.probe(0, (0.3, 0.1), forces=2)
    told.collapse(0)
    force = np.tile(60.0 * UP, (4, 1))
    for carried in (60.0, 30.0, 11.0, 9.0, 0.0):
        force = force.copy()
        force[0, 2] = carried
        told.truth(after=0.01, force_W=force)
    assert told.results["unload_s"] == [pytest.approx(0.04)]


def test_candidates_are_counted_once_and_each_press_is_a_probe():
    told = Told()
    for around in range(5):
        told.probe(0, FEET[0, :2], around=around)
        told.event("transition", 0, state="PROBE_AROUND")
    assert told.counts["candidates_tried"] == 1 and told.counts["probes"] == 5


# Verdicts against the press test ------------------------------------------------------------------------


def verdicts(told):
    return tuple(told.counts[key] for key in ("true_positives", "false_alarms", "false_negatives"))


@pytest.mark.parametrize(
    ("point", "collapses", "expected"),
    [(BAD, True, (1, 0, 0)), (GOOD, True, (0, 1, 0)), (BAD, False, (0, 0, 1)), (GOOD, False, (0, 0, 0))],
)
def test_a_probe_is_labelled_by_the_press_test(point, collapses, expected):
    told = Told(ON_PLANKS)
    told.probe(1, point, forces=3 if collapses else 6)
    told.collapse(1) if collapses else told.accept(1)
    assert verdicts(told) == expected


def test_a_collapse_after_the_last_force_is_a_collapse_and_nothing_else():
    for point, expected in ((BAD, (1, 0, 0)), (GOOD, (0, 1, 0))):
        told = Told(ON_PLANKS)
        told.probe(1, point, forces=6)
        told.collapse(1)
        assert verdicts(told) == expected


def test_a_probe_that_is_broken_off_has_no_verdict():
    told = Told(ON_PLANKS)
    told.probe(1, BAD, forces=4)
    told.event("transition", 1, state="RETURN_SAFE")
    told.event("transition", 1, state="STOPPED")
    assert verdicts(told) == (0, 0, 0) and told.counts["probes"] == 1


def test_the_press_is_as_strong_as_the_envelopes_peak():
    for peak, bad in ((40.0, 0), (120.0, 1)):
        told = Told(ON_PLANKS)
        told.probe(1, WEAK, envelope=(20.0, 20.0, 25.0, 30.0, 35.0, peak))
        told.accept(1)
        assert told.counts["false_negatives"] == bad


def test_a_late_collapse_where_the_ground_holds_is_a_false_alarm():
    for place, false in ((BAD, 0), (GOOD, 1)):
        told = Told(ON_PLANKS)
        told.probe(1, GOOD)
        told.accept(1)
        told.foot(1, place)  # it may have slipped off the beam
        told.event("late_collapse", 1)
        assert told.counts["late_collapses"] == 1
        assert told.counts["false_alarms"] == told.counts["late_false_alarms"] == false


def test_a_late_collapse_of_a_foot_that_truly_sank_is_right_wherever_it_stands():
    told = Told(ON_PLANKS)
    told.probe(1, GOOD)
    told.accept(1)
    told.status(1, LegStatus.COLLAPSING, "PRE_OPT")
    told.foot(1, (*GOOD, told.true.p_WF[1, 2] - 0.035))
    told.event("late_collapse", 1)
    assert told.counts["late_collapses"] == told.counts["missed_collapses"] == 1
    assert told.counts["false_alarms"] == 0


def test_a_late_collapse_is_judged_by_what_its_own_foothold_was_certified_for():
    for light, heavy in ((0, 1), (1, 0)):
        told = Told(ON_PLANKS)
        for leg in (0, 1):
            told.probe(leg, GOOD, envelope=(20.0, 20.0, 25.0, 30.0, 35.0, 40.0 if leg == light else 120.0))
            told.event("transition", leg, state="PROBE_AROUND")  # it comes back, and is accepted from there
            told.accept(leg)
        told.foot(light, WEAK)
        told.event("late_collapse", light)
        assert told.counts["false_alarms"] == 1
        told.foot(heavy, WEAK)
        told.event("late_collapse", heavy)
        assert told.counts["false_alarms"] == 1


def test_a_late_collapse_under_more_than_was_certified_is_judged_by_what_the_foot_bore():
    for carried, false in ((45.0, 1), (120.0, 0)):
        told = Told(ON_PLANKS)
        told.probe(1, GOOD, envelope=(20.0, 20.0, 25.0, 30.0, 35.0, 40.0))
        told.event("transition", 1, state="PROBE_AROUND")
        told.accept(1)
        force_W = np.zeros((4, 3))
        force_W[1, 2] = carried
        told.foot(1, WEAK, force_W=force_W)
        told.foot(1, WEAK, force_W=np.zeros((4, 3)))  # it has fallen off already when it is noticed
        told.event("late_collapse", 1)
        assert told.counts["false_alarms"] == false


def test_a_weaker_press_beside_the_foothold_takes_nothing_from_its_certificate():
    for strong, weak, false in ((120.0, 40.0, 0), (40.0, 40.0, 1)):
        told = Told(ON_PLANKS)
        for around, peak in ((0, strong), (1, weak)):
            told.probe(1, GOOD, envelope=(20.0, 20.0, 25.0, 30.0, 35.0, peak), around=around)
            told.event("transition", 1, state="PROBE_AROUND")
        told.accept(1)
        told.foot(1, WEAK)
        told.event("late_collapse", 1)
        assert told.counts["false_alarms"] == false


def test_a_foothold_that_the_map_had_certified_is_judged_by_that():
    for held, false in ((40.0, 1), (120.0, 0)):
        told = Told(ON_PLANKS)
        told.probe(0, GOOD)
        told.event("transition", 0, state="PROBE_AROUND")
        told.accept(0)
        told.foot(1, WEAK)
        told.event("contact", 1)
        told.accept(1, held_n=held)
        told.event("late_collapse", 1)
        assert told.counts["false_alarms"] == false


def test_a_foot_that_was_never_probed_is_judged_by_its_share_of_the_weight():
    told = Told(ON_PLANKS)
    told.truth()
    told.event("late_collapse", 2)  # on the run-up
    assert told.counts["false_alarms"] == 1
    told.foot(2, BAD)
    told.event("late_collapse", 2)
    assert told.counts["false_alarms"] == 1


def test_precision_is_of_all_alarms_and_recall_of_all_bad_points():
    told = Told(ON_PLANKS)
    assert told.results["precision"] is None and told.results["recall"] is None
    for point, collapses in ((BAD, True), (BAD, True), (BAD, False), (GOOD, True), (GOOD, False)):
        told.probe(1, point)
        told.collapse(1) if collapses else told.accept(1)
    for place in (GOOD, BAD, BAD):
        told.foot(1, place)
        told.event("late_collapse", 1)
    # Right: two in probes, two late; wrong: one each. Three bad points were probed, two found.
    assert told.results["precision"] == pytest.approx(4 / 6)
    assert told.results["recall"] == pytest.approx(2 / 3)


# Forces -------------------------------------------------------------------------------------------------


def test_forces_are_means_over_the_second_half_of_each_dwell():
    told = Told()
    told.truth()
    told.estimate()
    leg, t0 = 2, told.t
    tilted = np.array([0.6, 0.0, 0.8])
    interval, planned = 0.05, np.array([0.0, 41.0, 0.0, 62.0])  # along the normal, in each interval of the policy
    u = np.zeros((4, 24))
    u[:, 3 * leg : 3 * leg + 3] = np.outer(planned, tilted)
    told.grader("mpc/policy", Policy(t=t0 - 1e-6, valid=True, dt=interval, u=u))
    command = np.zeros((4, 3))
    command[leg] = 50.0 * tilted + [-0.8, 0.0, 0.6]
    told.grader("joint/command", JointCommand(force_W=command))
    asked = np.outer([5.0, 40.0, 60.0, 70.0, 80.0, 90.0, 100.0, 12.0], tilted)
    told.status(
        leg, LegStatus.PROBING, "PROBE", normal_W=tilted, probe_leg=leg, probe_t0=t0 - 1e-6,
        probe_dwell_s=DWELL_S, probe_force_W=asked,
    )  # fmt: skip
    told.event("transition", leg, state="PROBE")
    for index in range(2):
        for step in range(50):
            # Across the normal, and in the first half, anything may happen.
            late = step >= 25
            true = np.full((4, 3), 500.0)
            wave = 2.0 if step % 2 else -2.0
            true[leg] = (planned[2 * index + 1] + 3.0 + wave if late else 300.0) * tilted + [-8.0, 7.0, 6.0]
            seen = true.copy()
            seen[leg] += 4.0 * tilted
            told.grader("state/estimate", replace(told.estimated, force_W=seen))
            # Truth comes at the start of its interval, a microsecond into the dwell.
            told.truth(after=0.0, force_W=true)
            told.t = round(told.t + DT, 9)
        told.event("force_held", leg, force_index=index, asked_n=asked[index + 1] @ tilted)
    force, rmse = told.results["probe_force"], told.results["probe_rmse_n"]
    assert force["force_index"] == [0, 1] and force["asked_n"] == [40.0, 60.0]
    assert force["mpc_n"] == [41.0, 62.0] and force["wbc_n"] == [50.0, 50.0]
    # Another probe starts with a clean sheet.
    told.event("transition", leg, state="PROBE")
    told.event("force_held", leg, force_index=1)
    assert len(told.results["probe_force"]["true_n"]) == 2
    # Of 25 samples 13 are above the mean by the wave in one dwell, and in the other as well.
    wave = 2.0 / 25
    assert force["true_n"] == pytest.approx([44.0 + wave, 65.0 + wave], abs=0.01)
    assert force["estimated_n"] == pytest.approx([48.0 + wave, 69.0 + wave], abs=0.01)
    assert rmse["true_vs_mpc"] == pytest.approx(np.sqrt((13 * 5.0**2 + 12 * 1.0**2) / 25))
    assert rmse["estimate_vs_true"] == pytest.approx(4.0)


def test_the_least_margin_is_taken_from_lift_off_to_the_end_of_probing():
    told = Told()
    middle = FEET[[1, 2, 3], :2].mean(axis=0)

    def centre(inward, state, status):
        # Feet 1 and 2 are ends of the diagonal; leg 3 lies beyond it.
        along = FEET[1, :2] - FEET[2, :2]
        normal = np.array([along[1], -along[0]]) / np.hypot(*along)
        normal *= np.sign(normal @ (FEET[3, :2] - FEET[1, :2]))
        told.status(0, status, state)
        told.truth(com_W=np.append(0.5 * (FEET[1, :2] + FEET[2, :2]) + inward * normal, HEIGHT))

    told.truth(com_W=np.append(middle, HEIGHT))
    centre(-0.05, "MOVE", LegStatus.STANCE)
    centre(-0.05, "PROBE", LegStatus.STANCE)
    assert told.results["min_support_margin_m"] is None
    for inward, state, status in (
        (0.030, "DETECT_CONTACT", LegStatus.SWING),
        (0.025, "PROBE", LegStatus.PROBING),
        (0.028, "PROBE_AROUND", LegStatus.LANDING),
    ):
        centre(inward, state, status)
    assert told.results["min_support_margin_m"] == pytest.approx(0.025)
    centre(-0.01, "LEG_UP", LegStatus.SWING)
    assert told.results["min_support_margin_m"] == pytest.approx(-0.01)


# Estimate, motors, solver -------------------------------------------------------------------------------


def test_drift_is_the_last_error_over_the_distance():
    told = Told()
    told.truth()
    for x, error in ((1.0, (0.3, 0.0, -0.02)), (2.0, (0.03, -0.04, 0.01))):
        place = np.array([x, 0.0, HEIGHT])
        told.estimate(p_WB=place + error)
        told.truth(p_WB=place)
    assert told.results["distance_m"] == pytest.approx(2.0)
    assert told.results["estimator"]["xy_drift_per_m"] == pytest.approx(0.05 / 2.0)
    assert told.results["estimator"]["z_error_max_m"] == pytest.approx(0.02)


def test_who_has_not_moved_has_no_drift_per_metre():
    told = Told()
    told.truth()
    told.estimate(p_WB=HEIGHT * UP + [0.1, 0.0, 0.0])
    told.truth(p_WB=HEIGHT * UP + [0.19, 0.0, 0.0])
    assert told.results["estimator"]["xy_drift_per_m"] is None


def test_the_tilt_error_is_between_the_verticals():
    told = Told()
    told.estimate(quat_WB=turned(0.03, 0))
    told.truth(quat_WB=turned(0.01, 0))
    told.estimate(quat_WB=turned(0.5, 2))  # no error of tilt
    told.truth(quat_WB=turned(0.0, 2))
    assert told.results["estimator"]["tilt_error_max_rad"] == pytest.approx(0.02)


def test_energy_and_saturation_add_up_over_a_second():
    told = Told()
    for step in range(500):
        told.truth(power_w=80.0, saturated=step < 100)
    assert told.results["energy_j"] == pytest.approx(80.0)
    assert told.results["torque_saturation_s"] == pytest.approx(0.2)


def test_violations_are_the_largest_of_the_valid_policies():
    told = Told()
    told.truth()
    for valid, figures in ((True, (0.1, 5.0)), (True, (0.3, 2.0)), (False, (9.0, 9.0))):
        names = ("support_polygon", "friction_cone")
        told.grader("mpc/policy", Policy(valid=valid, constraint=names, violation=np.array(figures)))
    assert told.results["mpc_violation_max"] == {"support_polygon": 0.3, "friction_cone": 5.0}


# Holes, the map, the drop -------------------------------------------------------------------------------


UPHILL = Field(0.0, END_X, ((0.0, 0.0), (3.0, 0.3)))


def test_a_hole_is_below_the_surface_that_was_built_there():
    for z, stuck in ((0.15, False), (0.13, True)):  # the surface is at 20 cm
        told = Told(ON_PLANKS, UPHILL)
        told.truth(p_WF=FEET + 2.0 * UP)
        told.foot(1, (2.0, 0.0, z))
        told.truth(after=5.1)
        assert told.grader.outcome.failure == ("stuck" if stuck else "")
        assert told.counts["in_hole"] == stuck


def test_every_time_that_a_foot_goes_into_a_hole_counts_once():
    told = Told(ON_PLANKS)
    for z in (-0.05, -0.061, -0.059, -0.07, -0.03, -0.07):  # it never came out
        told.foot(2, (0.5, 0.0, z))
    assert told.counts["in_hole"] == 1
    told.foot(2, (0.5, 0.0, 0.02))
    told.foot(2, (0.5, 0.0, -0.07))
    told.foot(3, (0.5, 0.0, -0.07))
    assert told.counts["in_hole"] == 3


def test_the_map_rejects_the_foothold_of_the_leg_that_is_to_move():
    told = Told()
    told.truth()
    told.grader("foothold/regions", FootholdRegions(safe=np.zeros(4, bool)))  # nobody moves
    for leg, safe in ((2, [True, True, False, True]), (2, [False, False, True, False])):
        told.reference(state="SEND", leg=leg)
        told.grader("foothold/regions", FootholdRegions(safe=np.array(safe)))
    assert told.counts["rejected_by_map"] == 1


def test_candidates_are_told_for_each_foothold():
    told = Told()
    assert told.results["candidates_per_foothold"] is None
    for accepted in (False, True, True):
        told.probe(0, FEET[0, :2])
        told.accept(0) if accepted else told.collapse(0)
    assert told.results["candidates_per_foothold"] == pytest.approx(1.5)


# A trap -------------------------------------------------------------------------------------------------


class Trapped(Told):
    """On ground of which a press test is to say what it says of the planks."""

    def __init__(self):
        super().__init__(ON_PLANKS)
        grader = self.grader
        grader.outcome = Outcome(("planks", "trap"), FIELD, ROBOT.foot.radius, grader._labels.fails)

    def rest(self, seconds=3.1, **figures):
        """Stand still, told why."""
        self.reference(state="STOPPED", reason="no safe foothold", **figures)
        self.truth(after=seconds)
        self.reference()
        self.grader.outcome.finish(self.t, 100.0)


def test_on_a_trap_it_is_a_success_to_stand_on_what_holds():
    told = Trapped()
    told.truth()
    told.rest()
    assert told.grader.outcome.over and told.results["success"]
    assert told.results["stop_reason"] == "no safe foothold"


@pytest.mark.parametrize(("place", "good"), [(GOOD, True), (BAD, False), (WEAK, False)])
def test_on_a_trap_every_foot_has_to_stand_on_ground_that_bears_what_it_bears(place, good):
    told = Trapped()
    force_W = np.tile(60.0 * UP, (4, 1))
    force_W[1] = 120.0 * UP  # WEAK bears 40 N
    told.foot(1, place, force_W=force_W)
    told.rest()
    assert told.results["failure"] == (None if good else "stopped")


def test_what_a_foot_bore_before_the_robot_came_to_rest_is_no_matter():
    told = Trapped()
    force_W = np.tile(60.0 * UP, (4, 1))
    force_W[1] = 120.0 * UP
    told.truth(force_W=force_W)
    told.reference(state="RETURN_SAFE")
    force_W = force_W.copy()
    force_W[1] = 30.0 * UP
    told.foot(1, WEAK, force_W=force_W)
    told.rest()
    assert told.results["success"]


def test_on_a_trap_three_feet_or_a_short_rest_are_not_enough():
    told = Trapped()
    lifted = np.tile(60.0 * UP, (4, 1))
    lifted[3] = 0.0
    told.truth(force_W=lifted)
    told.rest()
    assert told.results["failure"] == "stopped"
    told = Trapped()
    told.truth()
    told.rest(2.0)
    assert told.results["failure"] == "stopped"


def test_who_crosses_a_trap_has_not_stopped():
    told = Trapped()
    told.truth(p_WF=FEET + [2.0, 0.0, 0.0])
    told.rest()
    assert told.results["failure"] == "crossed"
    told = Trapped()
    told.truth()
    told.rest(finished=True)
    assert told.results["failure"] == "crossed"


def test_a_fall_is_a_fall_on_a_trap_too():
    told = Trapped()
    told.truth(quat_WB=turned(1.0, 0))
    told.truth(quat_WB=turned(0.0, 0))
    told.rest()
    assert told.results["failure"] == "fell"


def test_an_accepted_foothold_beside_a_drop_has_its_distance():
    told = Told(FLAT, Field(0.0, END_X, ((0.0, 0.0), (0.5, 0.0), (0.5, -0.03), (2.0, -0.03))))
    for x, z in ((0.47, 0.0), (0.1, 0.0), (0.53, -0.03), (0.49, 0.0)):
        told.probe(1, (x, 0.0, z + ROBOT.foot.radius))
        told.accept(1)
    assert told.results["edge_distance_m"] == [pytest.approx(0.03), pytest.approx(0.01)]
