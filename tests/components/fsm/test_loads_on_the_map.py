"""From the feet to the map and back: what the state machine reports of a collapse is what the map keeps of it."""

import numpy as np
import pytest
from puppet import FOOT_Z, ROBOT, Puppet

from surefoot.bus.codec import decode, encode
from surefoot.bus.messages import FsmEvent
from surefoot.components.elevation_map.terrain_map import TerrainMap
from surefoot.config.elevation_map import ElevationMap

RL, FR = 2, 1


class Charted(Puppet):
    """A puppet whose events go over the wire to a blind map."""

    def __init__(self):
        self.chart = TerrainMap(ElevationMap(), ROBOT.foot.radius)
        self.chart.follow(np.zeros(3))
        super().__init__()

    def _report(self, kind, reason, **figures):
        super()._report(kind, reason, **figures)
        event = FsmEvent(t=self.t, valid=True, kind=kind, reason=reason, **figures)
        self.chart.note(decode(FsmEvent, encode(event)))

    def loads(self, p_WF):
        """Held and collapsed under, in the cell of a place [N]."""
        patch = self.chart.patch(np.array(p_WF[:2]), 0, 0, self.t)
        return patch.held_n[0, 0], patch.collapsed_n[0, 0]


def test_a_press_that_collapses_leaves_what_held_before_and_what_did_not():
    puppet = Charted()
    puppet.reach("PROBE")
    puppet.run(0.35)  # forces of 60 and 68 N are over, 76 N is asked
    place = puppet.feet[RL].copy()
    assert puppet.loads(place) == (pytest.approx(68.0, abs=1.0), 0.0)
    puppet.sunk[RL] = 0.035
    puppet.reach("LEG_UP")
    assert puppet.loads(place) == pytest.approx((68.0, 76.0), abs=1.0)
    # The alternative bears everything, and does not change what is known of the first.
    assert puppet.run(8.0, lambda: bool(puppet.kinds("accepted")))
    second = puppet.feet[RL]
    assert np.hypot(*(second - place)[:2]) > 0.05
    assert puppet.loads(second) == (pytest.approx(100.0, abs=1.0), 0.0)
    assert puppet.loads(place) == pytest.approx((68.0, 76.0), abs=1.0)


def test_a_foothold_that_gives_way_after_it_was_accepted_is_certified_for_nothing():
    puppet = Charted()
    assert puppet.run(8.0, lambda: bool(puppet.kinds("accepted")))
    place = puppet.feet[RL].copy()
    assert puppet.loads(place)[0] == pytest.approx(100.0, abs=1.0)
    puppet.load_n[RL] = 85.0
    puppet.tick()
    puppet.load_n[RL], puppet.sunk[RL] = 2.0, 0.04
    puppet.tick()
    assert puppet.kinds("late_collapse")
    assert puppet.loads(place) == pytest.approx((0.0, 85.0))


def test_ground_under_a_foot_that_was_never_probed_gives_way_under_what_stood_on_it():
    puppet = Charted()
    puppet.reach("DETECT_CONTACT")
    place = puppet.feet[FR].copy()
    puppet.sunk[FR] = 0.035
    puppet.tick()
    assert puppet.loads(place) == pytest.approx((0.0, 60.0))


def test_events_without_a_verdict_leave_no_loads():
    puppet = Charted()
    puppet.ground_z[RL] = FOOT_Z - 1.0  # no ground there: nothing has held, nothing has given way
    assert puppet.run(12.0, lambda: bool(puppet.kinds("rejected")))
    message = puppet.chart.message(puppet.t)
    assert not message.held_n.any() and not message.collapsed_n.any()
