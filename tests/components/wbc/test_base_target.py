"""The base's target as policies come, age and return: never a jump, always a way down."""

import numpy as np

from surefoot.bus.messages import Policy
from surefoot.components.wbc.base_target import BaseTarget, static_loads
from surefoot.config.wbc import Wbc

WEIGHT, DT = 240.0, 0.004
LOADS = np.full(4, WEIGHT / 4)
FEET = np.array([[0.24, 0.14, 0.0], [0.24, -0.14, 0.0], [-0.24, 0.14, 0.0], [-0.24, -0.14, 0.0]])


def policy(t, height=0.4, pitch=0.0, force=60.0):
    x = np.zeros((11, 24))
    x[:, 8], x[:, 10] = height, pitch
    u = np.zeros((10, 24))
    u[:, 2:12:3] = force
    return Policy(t=t, valid=True, dt=0.015, x=x, u=u, v=np.zeros((11, 18)))


def follow(target, script, t0, t1):
    """Targets over time; `script(t)` gives the policy or None."""
    times = t0 + DT * np.arange(round((t1 - t0) / DT))
    p, R = np.array([0.0, 0.0, 0.4]), np.eye(3)
    return [target.at(t, script(t), p, R, LOADS) for t in times]


def test_a_young_policy_is_followed_to_the_letter():
    target = BaseTarget(Wbc(), WEIGHT / 9.81)
    got = follow(target, lambda t: policy(t, 0.37), 0.0, 0.1)[-1]
    assert got.p_WB[2] == 0.37 and (got.force_W[:, 2] == 60.0).all() and target.held_s == 0.0


def test_without_one_the_base_is_held_then_lowered_then_given_up():
    settings = Wbc()
    target = BaseTarget(settings, WEIGHT / 9.81)
    follow(target, lambda t: policy(t, 0.4), 0.0, 0.1)
    held = follow(target, lambda t: None, 0.1, 0.1 + settings.hold_s)
    assert all(abs(each.p_WB[2] - 0.4) < 1e-9 for each in held) and not target.lowered
    np.testing.assert_allclose(held[-1].force_W[:, 2], WEIGHT / 4)
    lower_s = settings.lower_m / settings.lower_speed
    lowered = follow(target, lambda t: None, 0.1 + settings.hold_s, 0.2 + settings.hold_s + lower_s)
    heights = np.array([each.p_WB[2] for each in lowered])
    assert (np.diff(heights) <= 1e-12).all() and abs(heights[-1] - (0.4 - settings.lower_m)) < 1e-9
    assert target.lowered


def test_neither_loss_nor_return_of_the_policy_is_a_jump():
    target = BaseTarget(Wbc(), WEIGHT / 9.81)

    def script(t):
        return None if 0.5 <= t < 2.0 else policy(t, 0.42, 0.05, force=90.0)

    targets = follow(target, script, 0.0, 3.0)
    heights = np.array([each.p_WB[2] for each in targets])
    forces = np.array([each.force_W[0, 2] for each in targets])
    pitch = np.array([each.R_WB[0, 2] for each in targets])
    assert np.abs(np.diff(heights)).max() < 0.003  # a blend of 0.1 m over 0.3 s moves by 2 mm a cycle at most
    assert np.abs(np.diff(forces)).max() < 1.0
    assert np.abs(np.diff(pitch)).max() < 1e-3
    assert heights[-1] == 0.42 and forces[-1] == 90.0


def moments(loads, com):
    """About the centre of mass, of x and y levers [N m]."""
    return (loads[:, None] * (FEET - com)[:, :2]).sum(axis=0)


def test_what_statics_have_the_feet_bear_turns_nothing():
    rng = np.random.default_rng(2)
    for _ in range(50):
        com = np.array([*rng.uniform(-0.08, 0.08, 2), 0.4])
        loads = static_loads(FEET, com, np.ones(4, bool), WEIGHT)
        np.testing.assert_allclose(loads.sum(), WEIGHT)
        np.testing.assert_allclose(moments(loads, com), 0.0, atol=1e-9)
    np.testing.assert_allclose(static_loads(FEET, np.zeros(3), np.ones(4, bool), WEIGHT), WEIGHT / 4)


def test_three_feet_bear_what_is_theirs_and_one_in_the_air_nothing():
    com, stance = np.array([0.05, -0.02, 0.4]), np.array([True, True, False, True])
    loads = static_loads(FEET, com, stance, WEIGHT)
    assert loads[2] == 0.0 and (loads[stance] > 1.0).all()
    np.testing.assert_allclose(moments(loads, com), 0.0, atol=1e-9)


def test_a_foot_does_not_pull():
    loads = static_loads(FEET, np.array([-0.1, 0.1, 0.4]), np.array([True, True, False, True]), WEIGHT)
    assert loads.min() == 0.0 and loads[[0, 1, 3]].min() == 1.0


def test_a_heading_that_passes_pi_turns_the_nearer_way():
    target, turns = BaseTarget(Wbc(), WEIGHT / 9.81), policy(0.0)
    turns.x[:, 11] = np.where(np.arange(11) % 2, -np.pi + 0.01, np.pi - 0.01)
    for each in follow(target, lambda t: turns, 0.0, 0.15):
        assert each.R_WB[0, 0] < np.cos(np.pi - 0.011)
