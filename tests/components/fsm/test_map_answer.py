"""What the state machine does with the answer of the map: regions, heights, places unsafe or tried already."""

import numpy as np
from puppet import Puppet

from surefoot.config.fsm import Fsm

RL = 2
ROWS = np.array([[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -1.0, 0.0]])


def patch(foothold_WF, half_m=0.04):
    """Fields of an answer: footholds (4, 3), each in the middle of a square region."""
    a = np.tile(ROWS, (4, 1, 1))
    b = half_m - (a @ foothold_WF[..., None])[..., 0]
    return {"foothold_WF": foothold_WF, "region_a": a, "region_b": b, "region_active": np.ones(4, bool)}


def test_the_region_of_the_moving_leg_is_asked_of_the_mpc_until_the_foot_stands():
    puppet = Puppet(Fsm())
    puppet.map = lambda request: patch(request.target_WF)
    assert not puppet.cycle.reference.region_active
    puppet.reach("MOVE")
    reference = puppet.cycle.reference
    assert reference.swing_leg == RL and reference.region_active
    np.testing.assert_array_equal(reference.region_a, ROWS)
    np.testing.assert_allclose(reference.region_a @ reference.swing_to + reference.region_b, 0.04)
    puppet.reach("DETECT_CONTACT")
    assert puppet.cycle.reference.region_active
    puppet.reach("PROBE")  # the hop to the first point around is planned already: it may leave the region
    assert puppet.cycle.reference.swing_leg == RL and not puppet.cycle.reference.region_active
    puppet.reach("PROBE_AROUND")
    assert not puppet.cycle.reference.region_active and not puppet.cycle.reference.region_a.any()


def test_a_leg_that_is_put_back_or_raised_has_no_region():
    puppet = Puppet()
    puppet.map = lambda request: patch(request.target_WF)
    puppet.reach("DETECT_CONTACT")
    puppet.run(0.1)
    puppet.cycle.stop(puppet.observe(), "commanded stop")
    assert puppet.cycle.state == "RETURN_SAFE" and not puppet.cycle.reference.region_active
    puppet = Puppet()
    puppet.map = lambda request: patch(request.target_WF)
    puppet.reach("PROBE")
    puppet.run(0.3)
    puppet.sunk[RL] = 0.035
    puppet.reach("LEG_UP")
    assert not puppet.cycle.reference.region_active
    puppet.reach("DETECT_CONTACT")
    assert puppet.cycle.reference.region_active  # the alternative's
