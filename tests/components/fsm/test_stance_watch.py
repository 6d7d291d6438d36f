"""One foot that sinks stands out; a drift of the whole estimate does not."""

import numpy as np

from surefoot.components.fsm.stance_watch import StanceWatch

FEET = np.array([[0.24, 0.14, 0.0], [0.24, -0.14, 0.0], [-0.24, 0.14, 0.0], [-0.24, -0.14, 0.0]])
ALL = np.ones(4, bool)


def watch():
    result = StanceWatch()
    result.begin(FEET)
    return result


def test_a_drift_of_all_feet_is_no_displacement():
    drifting, feet = watch(), FEET + [0.02, -0.03, 0.05]
    drifting.update(feet, ALL)
    np.testing.assert_allclose(drifting.displacement(feet), 0.0, atol=1e-12)


def test_one_sinking_foot_is_seen_whether_it_stands_or_probes():
    feet = FEET + [0.01, 0.0, 0.0]
    feet[1] -= [0.0, 0.0, 0.035]
    for trusted in (ALL, np.array([True, False, True, True])):
        sinking = watch()
        sinking.update(feet, trusted)
        np.testing.assert_allclose(sinking.displacement(feet), [0.0, 0.035, 0.0, 0.0], atol=1e-12)


def test_with_two_trusted_feet_the_last_drift_stands():
    held = watch()
    held.update(FEET + [0.02, 0.0, 0.0], ALL)
    held.update(FEET + [0.03, 0.0, 0.0], np.array([True, False, False, True]))
    np.testing.assert_allclose(held.displacement(FEET + [0.03, 0.0, 0.0]), 0.01, atol=1e-12)


def test_the_load_that_a_foot_has_borne_begins_anew_where_it_is_trusted_or_set_down():
    loaded, standing = watch(), np.array([True, True, True, False])
    for force_n in ([60.0, 60.0, 60.0, 60.0], [90.0, 40.0, 50.0, 200.0]):
        loaded.load(np.array(force_n), standing)
    assert loaded.borne_n.tolist() == [90.0, 60.0, 60.0, 0.0]
    loaded.trust(0, FEET[0])
    loaded.touched(1, FEET[1])
    loaded.load(np.full(4, 30.0), standing)
    assert loaded.borne_n.tolist() == [30.0, 30.0, 60.0, 0.0]
    loaded.begin(FEET)
    assert not loaded.borne_n.any()


def test_a_safe_foothold_is_replaced_only_by_a_trusted_one_and_drifts_with_the_estimate():
    moving = watch()
    moving.touched(2, FEET[2] + [0.1, 0.0, 0.0])
    np.testing.assert_allclose(moving.safe(2), FEET[2])
    moving.update(FEET + [0.01, 0.0, 0.0], np.array([True, True, False, True]))
    np.testing.assert_allclose(moving.safe(2), FEET[2] + [0.01, 0.0, 0.0])
    moving.trust(2, FEET[2] + [0.1, 0.0, 0.0])
    np.testing.assert_allclose(moving.safe(2), FEET[2] + [0.1, 0.0, 0.0])
