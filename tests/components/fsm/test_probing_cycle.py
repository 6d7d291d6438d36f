"""The paths of Fig. 6 that a good walk never takes: stops, late collapses, no way back, time-outs."""

from dataclasses import replace

import numpy as np
import pytest
from puppet import FOOT_Z, Puppet

from surefoot.bus.messages import LegStatus
from surefoot.components.fsm.support_triangle import SupportTriangle
from surefoot.components.gait.swing_spline import SwingSpline
from surefoot.config.fsm import Fsm

STANCE, SWING, PROBING, COLLAPSING = LegStatus.STANCE, LegStatus.SWING, LegStatus.PROBING, LegStatus.COLLAPSING
RL, FL, RR, FR = 2, 0, 3, 1


def test_the_crawl_probes_leg_after_leg():
    puppet = Puppet()
    assert puppet.run(20.0, lambda: len(puppet.kinds("accepted")) == 4)
    assert [event[2]["leg"] for event in puppet.kinds("accepted")] == [RL, FL, RR, FR]
    assert not puppet.kinds("late_collapse") and not puppet.kinds("rejected")


@pytest.mark.parametrize(("state", "unanswered"), [("SEND", ("regions",)), ("OPT", ("plan",)), ("MOVE", ())])
def test_stop_on_four_feet_stands_at_once(state, unanswered):
    puppet = Puppet()
    puppet.unanswered = unanswered
    puppet.reach(state)
    puppet.cycle.stop(puppet.observe(), "commanded stop")
    assert puppet.cycle.state == "STOPPED" and puppet.status == [STANCE] * 4
    assert puppet.cycle.reference.swing_leg == -1 and puppet.cycle.reference.support_leg == -1


@pytest.mark.parametrize("state", ["DETECT_CONTACT", "PROBE", "PROBE_AROUND"])
def test_stop_with_a_leg_under_way_puts_it_back_where_it_was_safe(state):
    puppet = Puppet(Fsm())
    before = puppet.feet.copy()
    puppet.reach(state)
    puppet.run(0.1)
    puppet.cycle.stop(puppet.observe(), "commanded stop")
    puppet.reach("STOPPED")
    assert puppet.cycle.reason == "commanded stop" and puppet.status == [STANCE] * 4
    np.testing.assert_allclose(puppet.feet[RL], before[RL], atol=2e-3)


def test_a_foot_that_presses_is_unloaded_before_it_goes_back():
    puppet = Puppet()
    puppet.reach("PROBE")
    puppet.run(0.4)
    puppet.cycle.stop(puppet.observe(), "commanded stop")
    asked = puppet.cycle.reference.probe_force_W
    assert puppet.status[RL] == PROBING and puppet.cycle.reference.swing_t0 > puppet.t + 0.05
    assert asked[-1] @ [0, 0, 1] == pytest.approx(puppet.settings.unload_n)
    puppet.run(0.07)
    assert puppet.status[RL] == PROBING and puppet.observe().normal_force(RL) < 15.0
    assert puppet.run(0.1, lambda: puppet.status[RL] == SWING)


def test_a_stop_is_not_forgotten_when_another_foot_sinks_meanwhile():
    puppet = Puppet()
    puppet.reach("DETECT_CONTACT")
    puppet.cycle.stop(puppet.observe(), "commanded stop")
    puppet.sunk[FR] = 0.04
    puppet.reach("STOPPED")
    assert puppet.cycle.reason == "commanded stop" and puppet.kinds("late_collapse")
    assert puppet.status[FR] == COLLAPSING and puppet.cycle.reference.support_leg == FR


def test_a_stance_foot_that_sinks_while_another_swings_is_the_next_to_be_moved():
    puppet = Puppet()
    puppet.reach("DETECT_CONTACT")
    puppet.sunk[FR] = 0.035
    puppet.tick()
    assert puppet.cycle.state == "RETURN_SAFE" and puppet.status[FR] == COLLAPSING
    assert puppet.run(2.0, lambda: puppet.cycle.state == "SEND")
    assert puppet.status[FR] == COLLAPSING and puppet.status[RL] == STANCE
    assert puppet.run(8.0, lambda: bool(puppet.kinds("accepted")))
    assert puppet.kinds("accepted")[0][2]["leg"] == FR and puppet.status == [STANCE] * 4
    assert len(puppet.kinds("late_collapse")) == 1


def test_a_late_collapse_tells_the_most_that_the_foot_has_borne_since_it_was_accepted():
    """That is known of the load under which the ground gave way: the foot that falls bears next to nothing."""
    puppet = Puppet()
    assert puppet.run(8.0, lambda: bool(puppet.kinds("accepted")))  # RL was pressed with 100 N
    for load_n in (60.0, 82.0, 70.0):
        puppet.load_n[RL] = load_n
        puppet.tick()
    puppet.load_n[RL], puppet.sunk[RL] = 4.0, 0.04
    puppet.tick()
    figures = puppet.kinds("late_collapse")[0][2]
    assert figures["leg"] == RL and figures["held_n"] == pytest.approx(82.0)


def test_a_foot_that_sinks_is_lifted_as_soon_as_the_others_can_carry():
    puppet = Puppet()
    assert puppet.run(8.0, lambda: bool(puppet.kinds("accepted")))
    puppet.reach("MOVE")
    puppet.sunk[FR] = 0.05
    assert puppet.run(2.0, lambda: puppet.cycle.state == "LEG_UP")
    margin = SupportTriangle(puppet.feet, FR).margin(puppet.pose[:2])
    assert puppet.settings.margin_m <= margin < puppet.settings.shift_margin_m
    puppet.reach("SEND")
    assert puppet.cycle.counters["candidate"] == 0 and puppet.status[FR] == SWING
    assert puppet.run(8.0, lambda: len(puppet.kinds("accepted")) == 2)
    assert puppet.kinds("accepted")[1][2]["leg"] == FR


def test_a_foot_under_test_stays_down_when_another_sinks_and_is_tested_again():
    puppet = Puppet()
    puppet.reach("PROBE")
    puppet.run(0.15)  # the first force has not had its time
    puppet.sunk[FR] = 0.035
    puppet.tick()
    assert puppet.status[RL] == PROBING and puppet.status[FR] == COLLAPSING
    assert puppet.run(15.0, lambda: len(puppet.kinds("accepted")) == 2)
    assert [event[2]["leg"] for event in puppet.kinds("accepted")] == [FR, RL]


def test_a_foot_that_has_borne_some_when_another_sinks_is_certified_for_that():
    puppet = Puppet()
    puppet.reach("PROBE")
    puppet.run(0.35)  # 60 and 68 N
    puppet.sunk[FR] = 0.035
    puppet.tick()
    assert puppet.status[RL] == STANCE and puppet.status[FR] == COLLAPSING
    _kind, reason, figures, _state = puppet.kinds("accepted")[0]
    assert figures["leg"] == RL and figures["held_n"] == pytest.approx(68.0, abs=1.0)
    assert "FR gave way" in reason and "68 of 100 N" in reason
    assert puppet.run(8.0, lambda: len(puppet.kinds("accepted")) == 2)
    assert puppet.kinds("accepted")[1][2]["leg"] == FR


def test_a_stance_foot_that_yields_under_a_press_ends_it_and_moves_next():
    puppet = Puppet()
    puppet.reach("PROBE")
    puppet.run(0.35)
    puppet.sunk[FR] = 0.02  # not a collapse yet
    puppet.tick()
    assert puppet.status[RL] == PROBING and puppet.cycle.reference.probe_force_W[-1, 2] < 20.0
    puppet.run(0.1)
    _kind, reason, figures, _state = puppet.kinds("accepted")[0]
    assert figures["leg"] == RL and "FR yielded 2.0 cm" in reason and "68 of 100 N" in reason
    assert not puppet.kinds("late_collapse") and puppet.status == [STANCE] * 4
    assert puppet.run(8.0, lambda: len(puppet.kinds("accepted")) == 2)
    assert puppet.kinds("accepted")[1][2]["leg"] == FR


def test_a_foothold_that_failed_does_not_change_what_the_old_one_is_certified_for():
    puppet = Puppet(Fsm(probe_around=False, alternatives=0, put_off=False))
    assert puppet.run(20.0, lambda: len(puppet.kinds("accepted")) == 5)
    before = puppet.cycle.certified_n.copy()
    puppet.reach("PROBE")
    leg = int(puppet.cycle.reference.probe_leg)
    puppet.run(0.35)
    puppet.sunk[leg] = 0.035
    puppet.reach("STOPPED")
    assert (puppet.cycle.certified_n == before).all() and before[leg] > 90.0


def test_drift_of_the_estimate_is_no_collapse_even_with_two_trusted_feet():
    puppet = Puppet()
    puppet.reach("DETECT_CONTACT")
    puppet.feet += [0.028, 0.0, 0.0]  # near the limit already: what is left of it would not do
    puppet.tick()
    puppet.sunk[FR] = 0.04
    puppet.tick()
    puppet.feet += [0.004, 0.0, 0.0]
    puppet.run(2.0)
    assert [event[2]["leg"] for event in puppet.kinds("late_collapse")] == [FR]


def test_a_lost_leg_that_finds_no_ground_anywhere_ends_the_walk():
    puppet = Puppet(Fsm(probe_around=False, alternatives=0))
    puppet.reach("DETECT_CONTACT")
    puppet.sunk[FR] = 0.035
    puppet.run(3.0, lambda: puppet.cycle.state == "SEND")
    puppet.ground_z[FR] = -0.3
    assert puppet.run(6.0, lambda: bool(puppet.kinds("stopped")))
    assert puppet.kinds("rejected") and "no ground to go back to" in puppet.cycle.reason


def test_without_ground_to_go_back_to_the_robot_rests_on_three_feet():
    puppet = Puppet()
    puppet.reach("DETECT_CONTACT")
    puppet.run(0.2)
    puppet.ground_z[RL] = -1.0
    puppet.cycle.stop(puppet.observe(), "commanded stop")
    puppet.reach("STOPPED")
    assert puppet.cycle.reason.startswith("commanded stop; RL has no ground to go back to")
    assert puppet.status[RL] == SWING and puppet.cycle.reference.support_leg == RL
    assert puppet.feet[RL, 2] > -0.15
    puppet.run(1.0)
    puppet.ground_z[RL] = 0.0265
    puppet.cycle.walk(puppet.observe(), np.array([1.0, 0.0]), "forward")
    assert puppet.run(8.0, lambda: bool(puppet.kinds("accepted")))
    assert puppet.kinds("accepted")[0][2]["leg"] == RL


def test_a_leg_without_a_way_back_looks_for_it_once_also_off_balance():
    puppet = Puppet()
    puppet.reach("DETECT_CONTACT")
    puppet.run(0.2)
    puppet.ground_z[RL], puppet.tilt = -1.0, 0.5
    puppet.reach("STOPPED")
    assert "base tilted" in puppet.cycle.reason and "no ground to go back to" in puppet.cycle.reason
    assert puppet.cycle.reference.support_leg == RL
    puppet.run(5.0)
    assert puppet.cycle.state == "STOPPED"
    assert len([event for event in puppet.kinds("transition") if event[3] == "RETURN_SAFE"]) == 1


def resting_on_three(leg):
    """A robot that has lost the ground under a leg of the crawl, and has it in the air."""
    puppet = Puppet()
    assert puppet.run(
        60.0, lambda: puppet.cycle.state == "DETECT_CONTACT" and puppet.cycle.reference.swing_leg == leg
    )
    puppet.run(0.2)
    puppet.ground_z[leg] = -1.0
    puppet.cycle.stop(puppet.observe(), "commanded stop")
    puppet.reach("STOPPED")
    assert puppet.status[leg] == SWING
    return puppet


@pytest.mark.parametrize("leg", [FL, RR, FR])
def test_a_command_begins_with_the_leg_in_the_air_whatever_the_crawl_says(leg):
    puppet = resting_on_three(leg)
    puppet.ground_z[leg] = 0.0265
    puppet.cycle.walk(puppet.observe(), np.array([-1.0, 0.0]), "backward")
    for _ in range(2500):
        puppet.tick()
        assert [status != STANCE for status in puppet.status].count(True) <= 1
        if len(puppet.kinds("accepted")) and puppet.kinds("accepted")[-1][2]["leg"] == leg:
            break
    assert puppet.kinds("accepted")[-1][2]["leg"] == leg


def test_a_way_back_that_failed_once_and_was_found_then_is_forgotten():
    puppet = Puppet(Fsm(probe_around=False, alternatives=0))
    puppet.reach("DETECT_CONTACT")
    puppet.ground_z[RL] = -1.0
    puppet.reach("RETURN_SAFE")
    puppet.reach("LEG_UP")
    puppet.ground_z[RL] = 0.0265
    puppet.sunk[FR] = (
        0.04  # the leg sets off for its foothold again, and finds it; then it is the other one's turn
    )
    puppet.reach("PRE_OPT")
    puppet.reach("LEG_UP")
    assert puppet.status[FR] == SWING and puppet.status[RL] == STANCE
    assert puppet.run(8.0, lambda: bool(puppet.kinds("accepted")))
    assert puppet.kinds("accepted")[0][2]["leg"] == FR and not puppet.kinds("stopped")


def test_a_foot_that_sinks_while_the_robot_rests_is_leant_off_and_moved_first():
    puppet = Puppet(forward=False)
    puppet.run(1.2)
    puppet.sunk[FL] = 0.04
    puppet.run(1.5)
    margin = puppet.settings.margin_m + puppet.settings.margin_extra_m
    assert puppet.cycle.state == "STOPPED" and puppet.status[FL] == COLLAPSING
    assert SupportTriangle(puppet.feet, FL).margin(puppet.pose[:2]) >= margin - 1e-6
    puppet.cycle.walk(puppet.observe(), np.array([1.0, 0.0]), "forward")
    assert puppet.run(8.0, lambda: bool(puppet.kinds("accepted")))
    assert puppet.kinds("accepted")[0][2]["leg"] == FL


def test_a_base_that_does_not_arrive_leaves_no_swing_planned():
    puppet = Puppet()
    puppet.reach("MOVE")
    pose = puppet.pose.copy()
    while puppet.cycle.state == "MOVE":
        puppet.pose = pose
        puppet.t += 0.004
        puppet.cycle.step(puppet.observe())
        assert puppet.t < 10.0
    assert puppet.kinds("rejected") and puppet.cycle.state == "SEND"
    assert puppet.cycle.reference.swing_leg == -1 and puppet.cycle.reference.support_leg == -1


def test_a_base_that_tilts_ends_the_step():
    puppet = Puppet()
    puppet.reach("DETECT_CONTACT")
    puppet.tilt = 0.4
    puppet.run(0.1)
    assert puppet.cycle.state == "RETURN_SAFE" and "0.40 rad" in puppet.cycle.reason
    puppet.tilt = 0.0
    puppet.reach("STOPPED")
    assert "tilted" in puppet.cycle.reason


def test_a_force_that_falls_short_is_asked_once_more_then_certified_as_far_as_it_went():
    puppet = Puppet()
    puppet.weak = 0.6
    assert puppet.run(8.0, lambda: bool(puppet.kinds("accepted")))
    probes = [event for event in puppet.kinds("transition") if event[3] == "PROBE"]
    assert len(probes) == 2 and "again" in probes[1][1]
    _kind, reason, figures, _state = puppet.kinds("accepted")[0]
    assert figures["held_n"] == pytest.approx(60.0, abs=1.0) and "60 of 100 N" in reason


def test_no_more_is_asked_than_the_stance_can_press_with():
    puppet = Puppet(forward=False)
    puppet.feet[FR, 1] += 0.14  # close to the diagonal that RL presses against
    puppet.cycle.stand_up(puppet.observe())
    puppet.run(1.2)
    puppet.cycle.walk(puppet.observe(), np.array([1.0, 0.0]), "forward")
    assert puppet.run(8.0, lambda: bool(puppet.kinds("accepted")))
    first = next(event for event in puppet.kinds("transition") if event[3] == "PROBE")
    assert "of 100, statics allow no more" in first[1]
    figures = puppet.kinds("accepted")[0][2]
    assert figures["leg"] == RL and 10.0 < figures["held_n"] < 80.0


@pytest.mark.parametrize(("question", "topic"), [("regions", "foothold/regions"), ("plan", "trajopt/plan")])
def test_an_unanswered_question_is_asked_again(question, topic):
    puppet = Puppet()
    puppet.unanswered = (question,)
    puppet.run(2.2)
    assert any(f"no answer on {topic}" in event[1] for event in puppet.kinds("transition"))


def test_a_foothold_beside_which_the_ground_drops_is_on_an_edge():
    puppet = Puppet(Fsm())
    before = puppet.feet.copy()
    puppet.reach("PROBE_AROUND")
    puppet.ground_z[RL] -= 0.025
    assert puppet.run(2.0, lambda: puppet.cycle.state == "LEG_UP")
    rejected = puppet.kinds("rejected")
    assert len(rejected) == 1 and "2.5 cm lower" in rejected[0][1] and not puppet.kinds("collapse")
    puppet.reach("SEND")
    assert puppet.cycle.counters == {"candidate": 1, "around": 0}
    np.testing.assert_array_equal(puppet.cycle.reference.p_WF[FR], before[FR])


def test_a_small_step_beside_the_foothold_is_probed():
    puppet = Puppet(Fsm())
    puppet.reach("PROBE_AROUND")
    puppet.ground_z[RL] -= 0.015
    assert puppet.run(2.0, lambda: puppet.cycle.state == "PROBE")
    assert puppet.cycle.counters["around"] == 1 and not puppet.kinds("rejected")


def test_what_a_foot_meets_on_its_way_back_is_not_its_foothold():
    puppet = Puppet()
    puppet.reach("DETECT_CONTACT")
    puppet.run(0.2)
    puppet.cycle.stop(puppet.observe(), "commanded stop")
    puppet.ground_z[RL] = puppet.feet[RL, 2] + 0.2  # it touches something all the way
    puppet.run(puppet.settings.swing_s - 0.05)
    assert puppet.cycle.state == "RETURN_SAFE"
    puppet.reach("STOPPED")


def test_low_ground_ahead_lowers_the_base():
    heights = []
    for reserve in (0.0, 0.12):
        puppet = Puppet(Fsm(probe_around=False, depth_reserve_m=reserve))
        puppet.reach("DETECT_CONTACT")
        heights.append(puppet.cycle.reference.base_to[2])
    assert heights[1] < heights[0] - 0.005


def forbid(legs):
    """A map on which no cell is safe for some legs."""
    return lambda request: {"safe": ~np.isin(range(4), legs)}


def test_a_leg_without_a_foothold_waits_until_another_has_moved():
    puppet = Puppet()
    puppet.map = forbid([FL])
    assert puppet.run(8.0, lambda: len(puppet.kinds("accepted")) == 1)
    assert puppet.run(8.0, lambda: len(puppet.kinds("accepted")) == 2)
    assert [event[2]["leg"] for event in puppet.kinds("accepted")] == [RL, RR]
    assert "FL is put off" in [event for event in puppet.kinds("transition") if event[3] == "PRE_OPT"][-2][1]
    puppet.map = forbid([])
    assert puppet.run(16.0, lambda: FL in [event[2]["leg"] for event in puppet.kinds("accepted")])


def test_no_leg_runs_away_from_one_that_finds_no_foothold():
    puppet = Puppet()
    start = puppet.feet.copy()
    puppet.map = forbid([FL])
    puppet.reach("STOPPED", 200.0)
    assert "no safe foothold" in puppet.cycle.reason and not puppet.cycle.finished
    advance = (puppet.feet - start)[:, 0]
    assert advance[FL] == 0.0 and 0.05 < advance.max() < 0.25
    assert puppet.status == [STANCE] * 4


def test_without_putting_off_a_leg_without_a_foothold_stops_the_robot():
    puppet = Puppet(Fsm(probe_around=False, put_off=False))
    puppet.map = forbid([RL])
    puppet.reach("STOPPED", 3.0)
    assert len(puppet.kinds("rejected")) == 4 and not puppet.kinds("accepted")


@pytest.mark.parametrize(("share", "met"), [(1.0, False), (0.8, False), (0.1, True)])
def test_only_a_foot_that_has_been_stopped_has_met_ground_early(share, met):
    puppet = Puppet()
    puppet.reach("DETECT_CONTACT")
    assert puppet.run(2.0, lambda: puppet.t > puppet.cycle.reference.swing_t0 + 0.36)
    now = puppet.observe()
    _, planned, _ = SwingSpline(puppet.cycle.reference).sample(np.array([now.t]))
    force_W, v_WF, contact = np.tile([0.0, 0.0, 30.0], (4, 1)), np.zeros((4, 3)), np.ones(4, bool)
    v_WF[RL] = share * planned[0]
    assert planned[0, 2] < -0.05
    puppet.cycle.step(replace(now, estimate=replace(now.estimate, force_W=force_W, v_WF=v_WF, contact=contact)))
    assert (puppet.cycle.state == "PROBE") == met


def test_the_base_comes_back_with_a_leg_that_has_set_out_far_ahead():
    puppet = Puppet(Fsm(probe_around=False, alternatives=0), forward=False)
    puppet.feet[RL, 0] -= 0.23
    puppet.cycle.stand_up(puppet.observe())
    puppet.cycle.walk(puppet.observe(), np.array([1.0, 0.0]), "forward")
    far = 0.17 * np.array([1.0, 0.0, 0.0])
    puppet.map = lambda request: {"foothold_WF": request.target_WF + far}
    puppet.placed = lambda request: request.target_WF + far
    puppet.reach("DETECT_CONTACT")
    safe, ahead = puppet.feet[RL].copy(), puppet.pose.copy()
    puppet.ground_z[RL] = -1.0
    puppet.reach("RETURN_SAFE")
    puppet.ground_z[RL] = FOOT_Z - 0.025
    assert puppet.run(3.0, lambda: puppet.cycle.state != "RETURN_SAFE")
    assert puppet.cycle.state == "PRE_OPT", puppet.cycle.reason
    assert np.hypot(*(puppet.feet[RL] - safe)[:2]) < 0.01 and puppet.pose[0] < ahead[0]
