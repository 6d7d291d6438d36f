"""The whole stack in lockstep: probed steps on flat ground, a collapse and the recovery on planks.

The first two with the paper's MPC; what the state machine does in other cases is seen with its light profile.
"""

import numpy as np
import pytest

from surefoot.components.fsm.support_triangle import SupportTriangle
from surefoot.components.lockstep import Lockstep
from surefoot.config.deployment import Deployment
from surefoot.config.fsm import Fsm
from surefoot.config.hw import Hw
from surefoot.config.mpc import Mpc
from surefoot.config.terrain import Planks, Terrain

LIGHT = Mpc(profile="light")
# The first foothold of FR lies 4 cm beyond the hinge of a board on a spring too weak for it.
WEAK = Terrain(kind="planks", planks=Planks(start_offset_m=0.0, stiffness=60.0))


class Run:
    def __init__(self, deployment, command="forward"):
        self.stack = Lockstep(deployment)
        self.events, self.truth, self.references = [], [], []
        self.stack.listen(self.hear)
        self.stack.command(command)

    def hear(self, key, message):
        if key == "fsm/event":
            self.events.append(message)
        elif key == "sim/truth":
            self.truth.append(message)
        elif key == "fsm/reference":
            self.references.append(message)

    def kinds(self, kind):
        return [event for event in self.events if event.kind == kind]

    def until(self, limit_s, kind, count=1):
        self.stack.run(limit_s, lambda: len(self.kinds(kind)) >= count)
        return self.kinds(kind)

    def tilt(self):
        return max(2.0 * np.arccos(min(1.0, abs(truth.quat_WB[0]))) for truth in self.truth)


@pytest.fixture(scope="module")
def flat():
    run = Run(Deployment(hw=Hw(seed=1)))
    run.until(30.0, "accepted", 2)
    return run


def test_on_flat_ground_every_foothold_is_borne_and_accepted(flat):
    assert [event.leg for event in flat.kinds("accepted")] == [2, 0]
    assert not flat.kinds("collapse") and not flat.kinds("late_collapse") and not flat.kinds("rejected")


def test_each_foothold_and_four_points_around_it_bear_six_forces(flat):
    held = [event for event in flat.kinds("force_held") if event.leg == 2]
    assert [(event.around, event.force_index) for event in held] == [(a, i) for a in range(5) for i in range(6)]
    asked = np.array([event.asked_n for event in held]).reshape(5, 6)
    assert (np.diff(asked, axis=1) >= 0.0).all() and asked.max() > 90.0
    assert all(event.held_n > 0.8 * event.asked_n - 3.0 for event in held)


def test_the_foot_is_unloaded_before_each_hop(flat):
    hops = [event for event in flat.kinds("transition") if event.state == "PROBE_AROUND" and event.leg == 2]
    at = {round(truth.t, 3): truth for truth in flat.truth}
    assert len(hops) == 5
    assert max(at[round(hop.t, 3)].force_W[2, 2] for hop in hops) < 35.0


def test_the_base_stays_inside_the_other_three_feet(flat):
    triangle = SupportTriangle(flat.truth[-1].p_WF, 0)
    moved = [truth for truth in flat.truth if flat.kinds("accepted")[0].t + 1.5 < truth.t]
    assert min(triangle.margin(truth.com_W[:2]) for truth in moved) > 0.015


def test_the_foot_advances_and_the_robot_stays_level(flat):
    moved = flat.truth[-1].p_WF - flat.truth[600].p_WF
    assert moved[2, 0] > 0.08 and moved[0, 0] > 0.08
    assert np.abs(moved[[1, 3], :2]).max() < 0.015
    assert flat.tilt() < 0.1


def test_the_goal_ends_the_walk_and_sit_lies_down():
    run = Run(Deployment(mpc=LIGHT, fsm=Fsm(goal_m=0.05, probe_around=False)))
    run.stack.run(40.0, lambda: bool(run.references) and run.references[-1].finished)
    assert run.references[-1].finished and run.references[-1].state == "STOPPED"
    run.stack.command("sit")
    run.stack.run(run.stack.t + 6.0, lambda: run.references[-1].state == "DAMP")
    assert run.references[-1].state == "DAMP" and run.truth[-1].p_WB[2] < 0.2


def test_a_plank_that_gives_way_is_left_and_another_foothold_found():
    run = Run(Deployment(terrain=Terrain(kind="planks"), fsm=Fsm(crawl_order=(1, 2, 0, 3), probe_around=False)))
    collapses = run.until(20.0, "collapse")
    assert collapses and 0.03 < collapses[0].displacement_m < 0.045
    accepted = run.until(run.stack.t + 12.0, "accepted", len(run.kinds("accepted")) + 1)
    assert accepted[-1].leg == collapses[0].leg and accepted[-1].candidate > 0
    assert run.tilt() < 0.15
    assert all(truth.body_contact == "" for truth in run.truth)


def test_a_foot_that_sinks_away_under_its_press_throws_nobody():
    fsm = Fsm(crawl_order=(1, 2, 0, 3), probe_around=False)
    run = Run(Deployment(mpc=LIGHT, terrain=WEAK, fsm=fsm))
    collapses = run.until(15.0, "collapse", 2)
    assert [event.leg for event in collapses] == [1, 1]
    run.stack.run(run.stack.t + 1.5)
    assert run.references[-1].state != "DAMP" and run.tilt() < 0.15


def test_without_a_foothold_the_leg_returns_and_the_robot_stops():
    fsm = Fsm(crawl_order=(1, 2, 0, 3), alternatives=0, probe_around=False, put_off=False)
    run = Run(Deployment(mpc=LIGHT, terrain=WEAK, fsm=fsm))
    stopped = run.until(15.0, "stopped")
    assert stopped and "no safe foothold" in stopped[0].reason
    run.stack.run(run.stack.t + 1.5)
    assert (run.truth[-1].force_W[:, 2] > 20.0).all() and run.tilt() < 0.15
    run.stack.command("direction -0.8 0.6")  # the operator gives a new one, and the walk goes on
    accepted = run.until(run.stack.t + 15.0, "accepted", len(run.kinds("accepted")) + 1)
    assert run.stack.t < 31.0 and accepted[-1].t > stopped[0].t and run.tilt() < 0.15


def test_stop_in_mid_swing_puts_the_foot_back():
    run = Run(Deployment(mpc=LIGHT))
    run.stack.run(20.0, lambda: bool(run.references) and run.references[-1].state == "DETECT_CONTACT")
    run.stack.run(run.stack.t + 0.2)
    run.stack.command("stop")
    run.stack.run(run.stack.t + 3.0)
    assert run.references[-1].state == "STOPPED" and run.references[-1].reason == "commanded stop"
    assert (run.truth[-1].force_W[:, 2] > 20.0).all()


def test_a_pause_in_mid_swing_finishes_the_step_and_a_skip_under_load_throws_nobody():
    run = Run(Deployment(mpc=LIGHT, fsm=Fsm(probe_around=False)))
    run.stack.run(20.0, lambda: bool(run.references) and run.references[-1].state == "DETECT_CONTACT")
    run.stack.command("pause")
    run.stack.run(run.stack.t + 5.0, lambda: run.references[-1].state == "STOPPED")
    assert run.references[-1].reason == "commanded pause" and len(run.kinds("accepted")) == 1
    run.stack.run(run.stack.t + 1.0)
    assert (run.truth[-1].force_W[:, 2] > 20.0).all()
    run.stack.command("resume")
    run.stack.run(run.stack.t + 5.0, lambda: run.references[-1].state == "PROBE")
    leg = run.references[-1].leg
    run.stack.run(run.stack.t + 0.6)
    assert run.truth[-1].force_W[leg, 2] > 60.0
    run.stack.command("skip")
    run.stack.run(run.stack.t + 1.0, lambda: run.references[-1].state == "LEG_UP")
    assert run.truth[-1].force_W[leg, 2] < 35.0
    accepted = run.until(run.stack.t + 6.0, "accepted", 2)
    assert accepted[-1].leg == leg and accepted[-1].candidate == 1 and run.tilt() < 0.1


def test_stop_while_an_alternative_is_planned_puts_the_raised_foot_back():
    fsm = Fsm(crawl_order=(1, 2, 0, 3), probe_around=False)
    run = Run(Deployment(mpc=LIGHT, terrain=WEAK, fsm=fsm))
    run.until(20.0, "collapse")
    run.stack.run(run.stack.t + 5.0, lambda: run.references[-1].state == "OPT")
    assert run.references[-1].state == "OPT" and run.truth[-1].force_W[1, 2] == 0.0
    run.stack.command("stop")
    run.stack.run(run.stack.t + 0.1)
    assert run.references[-1].state == "RETURN_SAFE"
    run.stack.run(run.stack.t + 3.0)
    assert run.references[-1].state == "STOPPED" and run.references[-1].reason == "commanded stop"
    assert (run.truth[-1].force_W[:, 2] > 20.0).all() and run.tilt() < 0.2


def test_an_unknown_command_is_refused_by_name():
    run = Run(Deployment(mpc=LIGHT), "moonwalk")
    refused = run.until(0.1, "refused")
    assert "moonwalk" in refused[0].reason and "forward" in refused[0].reason
