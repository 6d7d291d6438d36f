"""A foothold that the map knows to bear enough is accepted on contact; all others are probed."""

import numpy as np
import pytest
from puppet import FOOT_Z, Puppet

from surefoot.bus.messages import LegStatus
from surefoot.config.fsm import Fsm

RL, FL = 2, 0
PEAK_N = 100.0  # of the puppet's envelope
AWAY = np.array([1.0, 0.0, 0.0])


def walking(held_n, **settings):
    """A robot whose map knows what the ground bears under the hind left foot, and nothing elsewhere."""
    puppet = Puppet(Fsm(**({"adaptive_probing": True} | settings)))
    puppet.map = lambda request: {"held_n": np.array([0.0, 0.0, held_n, 0.0])}
    return puppet


def forces_before_acceptance(puppet, seconds=15.0):
    assert puppet.run(seconds, lambda: bool(puppet.kinds("accepted")))
    return len(puppet.kinds("force_held"))


def test_a_foothold_known_to_bear_enough_is_accepted_on_contact_with_what_is_known():
    puppet = walking(118.0)
    assert forces_before_acceptance(puppet) == 0
    _kind, reason, figures, _state = puppet.kinds("accepted")[0]
    assert "118 N of 100 N needed" in reason and "not probed again" in reason
    assert figures["leg"] == RL and figures["held_n"] == 118.0 and figures["displacement_m"] == 0.0
    assert puppet.cycle.certified_n[RL] == 118.0 and puppet.status == [LegStatus.STANCE] * 4
    assert puppet.cycle.reference.support_leg == -1 and puppet.cycle.reference.probe_leg == -1
    states = {event[3] for event in puppet.events}
    assert "PROBE" not in states and "PROBE_AROUND" not in states
    # The next leg's foothold is unknown: it is probed, and the points around it.
    assert puppet.run(15.0, lambda: len(puppet.kinds("accepted")) == 2)
    assert puppet.kinds("accepted")[1][2]["leg"] == FL and len(puppet.kinds("force_held")) == 30


@pytest.mark.parametrize("held_n", [0.0, PEAK_N - 1.0])
def test_what_is_not_known_or_not_enough_is_probed(held_n):
    puppet = walking(held_n)
    assert forces_before_acceptance(puppet) == 30


def test_without_the_setting_everything_is_probed():
    puppet = walking(200.0, adaptive_probing=False, probe_around=False)
    assert forces_before_acceptance(puppet) == 6


@pytest.mark.parametrize(("off_m", "forces"), [(0.024, 0), (0.029, 6)])
def test_only_the_very_spot_counts(off_m, forces):
    puppet = walking(118.0, probe_around=False)
    puppet.reach("MOVE")
    puppet.reach("DETECT_CONTACT")
    puppet.run(0.4)
    puppet.cycle.reference.swing_to[:] += off_m * AWAY  # the foot comes down beside what was asked
    assert forces_before_acceptance(puppet) == forces


def test_ground_that_lies_lower_than_the_map_has_it_is_probed():
    puppet = walking(118.0, probe_around=False)
    puppet.ground_z[RL] = FOOT_Z - 0.03
    assert forces_before_acceptance(puppet) == 6


def test_a_foot_that_is_put_back_is_not_taken_for_one_at_its_new_foothold():
    puppet = walking(118.0)
    puppet.reach("DETECT_CONTACT")
    puppet.run(0.1)
    puppet.cycle.stop(puppet.observe(), "commanded stop")
    puppet.reach("STOPPED")
    assert not puppet.kinds("accepted") and puppet.cycle.certified_n[RL] == 0.0
