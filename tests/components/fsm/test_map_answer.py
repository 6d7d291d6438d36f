"""What the state machine does with the answer of the map: regions, heights, places unsafe or tried already."""

import numpy as np
from puppet import FOOT_Z, Puppet

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


def test_a_place_that_the_map_forbids_is_rejected_with_its_reason_and_no_foot_is_moved():
    puppet = Puppet()
    reasons = ("", "", "no safe cell within 7 cm: edge", "")
    asked = []

    def only_the_second(request):
        asked.append(request.target_WF[RL].copy())
        return {"safe": np.array([True, True, len(asked) > 1, True]), "reasons": reasons}

    puppet.map = only_the_second
    puppet.reach("MOVE")
    _kind, reason, figures, _state = puppet.kinds("rejected")[0]
    assert reason == reasons[RL] and figures["leg"] == RL
    assert len(puppet.kinds("rejected")) == 1 and puppet.cycle.counters["candidate"] == 1
    assert not any(event[3] == "DETECT_CONTACT" for event in puppet.events)
    np.testing.assert_allclose(puppet.cycle.reference.swing_to[:2], asked[1][:2])


def test_without_any_safe_place_the_robot_stops_without_a_step():
    puppet = Puppet()
    puppet.map = lambda request: {"safe": np.zeros(4, bool)}
    before = puppet.feet.copy()
    assert puppet.run(3.0, lambda: bool(puppet.kinds("stopped")))
    assert "no safe foothold" in puppet.cycle.reason and len(puppet.kinds("rejected")) == 16
    np.testing.assert_array_equal(puppet.feet, before)


def test_a_swing_ends_at_the_height_that_the_map_knows():
    puppet = Puppet()
    puppet.map = lambda request: {"foothold_WF": request.target_WF + [0.0, 0.01, 0.05]}
    puppet.ground_z[RL] = FOOT_Z + 0.05
    puppet.reach("MOVE")
    np.testing.assert_allclose(puppet.cycle.reference.swing_to[2], FOOT_Z + 0.05, atol=1e-9)
    puppet.reach("PROBE")
    contact = puppet.kinds("contact")[0]
    assert abs(contact[2]["p_WF"][2] - FOOT_Z - 0.05) < 1e-6 and not puppet.kinds("rejected")


def test_a_cell_that_gave_way_is_not_probed_again_for_the_next_candidate():
    puppet = Puppet()
    cells = []

    def same_cell_twice(request):
        cells.append(request.target_WF.copy() if len(cells) in (0, 2) else cells[0] + [0.012, 0.0, 0.0])
        return {"foothold_WF": cells[-1]}

    puppet.map = same_cell_twice
    puppet.reach("PROBE")
    puppet.run(0.3)
    puppet.sunk[RL] = 0.035
    puppet.reach("LEG_UP")
    puppet.reach("DETECT_CONTACT")
    _kind, reason, _figures, _state = puppet.kinds("rejected")[0]
    assert "12 mm from a foothold tried in vain" in reason
    assert puppet.cycle.counters["candidate"] == 2 and len(puppet.kinds("collapse")) == 1
    # What failed for one leg is not held against the next one, nor against the same leg's next turn.
    assert puppet.run(20.0, lambda: len(puppet.kinds("accepted")) == 5)
    assert len(puppet.kinds("rejected")) == 1


def test_a_place_that_the_optimisation_chooses_again_is_not_tried_twice():
    """It may place a foot anywhere in its region: two candidates can end in one place."""
    puppet = Puppet()
    puppet.map = lambda request: patch(request.target_WF, half_m=0.08)
    one_place = puppet.feet + [0.16, 0.0, 0.0]
    puppet.placed = lambda request: one_place
    puppet.ground_z[RL] = FOOT_Z - 1.0  # no ground there
    puppet.reach("LEG_UP")
    puppet.ground_z[RL] = FOOT_Z
    puppet.reach("SEND")
    puppet.placed = lambda request: one_place if puppet.cycle.counters["candidate"] < 2 else request.target_WF
    puppet.reach("DETECT_CONTACT")
    reasons = [event[1] for event in puppet.kinds("rejected")]
    assert len(reasons) == 2 and "no contact" in reasons[0] and "0 mm from a foothold tried in vain" in reasons[1]
    assert puppet.cycle.counters["candidate"] == 2
    np.testing.assert_allclose(puppet.kinds("rejected")[1][2]["p_WF"], one_place[RL])
