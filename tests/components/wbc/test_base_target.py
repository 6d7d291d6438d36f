"""The base's target as policies come, age and return: never a jump, always a way down."""

import numpy as np

from surefoot.bus.messages import Policy
from surefoot.components.wbc.base_target import BaseTarget
from surefoot.config.wbc import Wbc

STANCE = np.ones(4, bool)
WEIGHT, DT = 240.0, 0.004


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
    return [target.at(t, script(t), p, R, STANCE) for t in times]


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
