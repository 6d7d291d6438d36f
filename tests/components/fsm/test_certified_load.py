"""What a foothold has borne: told with its acceptance, kept, and where that is asked for, never exceeded."""

import numpy as np
import pytest
from puppet import Puppet

from surefoot.bus.messages import LegStatus
from surefoot.config.fsm import Fsm

RL, FL = 2, 0


def walking(**settings):
    return Puppet(Fsm(probe_around=False, **settings))


def caps(puppet):
    return puppet.cycle.message(puppet.t).force_max_n


def requested(puppet):
    """The caps of the next request for a plan."""
    puppet.unanswered = ("plan",)
    puppet.reach("OPT")
    caps = puppet.cycle.questions.plan_request.force_max_n
    puppet.unanswered = ()
    return caps


def test_acceptance_tells_the_force_held_and_how_far_the_ground_gave_under_it():
    puppet = walking()
    puppet.reach("PROBE")
    puppet.run(0.15)
    puppet.sunk[RL] = 0.006
    puppet.run(0.2)
    puppet.sunk[RL] = 0.011
    assert puppet.run(8.0, lambda: bool(puppet.kinds("accepted")))
    figures = puppet.kinds("accepted")[0][2]
    assert figures["held_n"] == pytest.approx(100.0, abs=1.0)
    assert figures["displacement_m"] == pytest.approx(0.011, abs=1e-3)
    assert puppet.cycle.certified_n[RL] == figures["held_n"]
    assert puppet.cycle.displaced_m[RL] == figures["displacement_m"]


def test_points_around_do_not_change_what_the_foothold_itself_gave():
    puppet = Puppet(Fsm())
    puppet.reach("PROBE")
    puppet.run(0.15)
    puppet.sunk[RL] = 0.006
    puppet.reach("PROBE_AROUND")
    assert puppet.run(10.0, lambda: bool(puppet.kinds("accepted")))
    assert puppet.kinds("accepted")[0][2]["displacement_m"] == pytest.approx(0.006, abs=1e-3)


def test_without_the_setting_nothing_is_capped():
    puppet = walking()
    assert puppet.run(20.0, lambda: len(puppet.kinds("accepted")) == 4)
    assert (puppet.cycle.certified_n > 90.0).all()
    assert not caps(puppet).any() and not requested(puppet).any()


def test_a_foothold_is_capped_from_its_acceptance_until_the_foot_leaves_it():
    puppet = walking(cap_forces=True)
    assert not requested(puppet).any()  # nothing has been probed yet
    puppet.reach("PROBE")
    assert not caps(puppet).any()
    assert puppet.run(8.0, lambda: bool(puppet.kinds("accepted")))
    held_n = puppet.kinds("accepted")[0][2]["held_n"]
    expected = np.zeros(4)
    expected[RL] = held_n
    np.testing.assert_array_equal(caps(puppet), expected)
    np.testing.assert_array_equal(requested(puppet), expected)
    assert puppet.run(20.0, lambda: len(puppet.kinds("accepted")) == 4)
    assert requested(puppet)[RL] == held_n
    puppet.reach("MOVE")
    assert puppet.cycle.reference.swing_leg == RL and caps(puppet)[RL] == held_n
    puppet.reach("DETECT_CONTACT")
    assert caps(puppet)[RL] == 0.0 and (caps(puppet)[[0, 1, 3]] > 90.0).all()
    puppet.reach("PROBE")
    assert not caps(puppet).any()  # the foot across bears the press, whatever it is certified for


def test_a_foot_that_is_put_back_stands_on_what_was_certified_before():
    puppet = walking(cap_forces=True)
    assert puppet.run(20.0, lambda: len(puppet.kinds("accepted")) == 4)
    before = puppet.cycle.certified_n.copy()
    puppet.reach("DETECT_CONTACT")
    puppet.run(0.1)
    puppet.cycle.stop(puppet.observe(), "commanded stop")
    assert caps(puppet)[RL] == 0.0
    puppet.reach("STOPPED")
    np.testing.assert_array_equal(caps(puppet), before)


def test_a_foothold_that_sinks_has_no_certificate_left_to_obey():
    puppet = walking(cap_forces=True)
    assert puppet.run(20.0, lambda: len(puppet.kinds("accepted")) == 4)
    puppet.reach("MOVE")
    puppet.sunk[FL] = 0.035
    puppet.tick()
    assert puppet.status[FL] == LegStatus.COLLAPSING
    assert caps(puppet)[FL] == 0.0 and caps(puppet)[RL] > 90.0


def test_after_lying_down_nothing_is_known_of_the_ground():
    puppet = walking(cap_forces=True)
    assert puppet.run(8.0, lambda: bool(puppet.kinds("accepted")))
    puppet.cycle.stand_up(puppet.observe())
    assert not caps(puppet).any() and not puppet.cycle.certified_n.any()
