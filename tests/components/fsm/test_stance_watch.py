"""One foot that sinks stands out; a drift of the whole estimate does not."""

import numpy as np

from surefoot.components.fsm.stance_watch import StanceWatch

FEET = np.array([[0.24, 0.14, 0.0], [0.24, -0.14, 0.0], [-0.24, 0.14, 0.0], [-0.24, -0.14, 0.0]])


def watch():
    result = StanceWatch()
    result.anchor_W[:] = FEET
    return result


def test_a_drift_of_all_feet_is_no_displacement():
    moved = watch().displacement(FEET + [0.02, -0.03, 0.05], np.ones(4, bool))
    np.testing.assert_allclose(moved, 0.0, atol=1e-12)


def test_one_sinking_foot_is_seen_whether_it_stands_or_probes():
    feet = FEET + [0.01, 0.0, 0.0]
    feet[1] -= [0.0, 0.0, 0.035]
    for stance in (np.ones(4, bool), np.array([True, False, True, True])):
        moved = watch().displacement(feet, stance)
        np.testing.assert_allclose(moved[1], [0.0, 0.0, -0.035], atol=1e-12)
        np.testing.assert_allclose(np.delete(moved, 1, axis=0), 0.0, atol=1e-12)
