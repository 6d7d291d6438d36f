"""A pad sinks by the force over its stiffness, well damped, and bears."""

import mujoco
import numpy as np
import pytest

from surefoot.config.deployment import Deployment
from surefoot.config.hw import Hw
from surefoot.config.terrain import Foam, Terrain
from surefoot.hw.mujoco.press_test import PressTest
from surefoot.hw.mujoco.scene import build_scene

FOAM = Foam()


def deployment(seed=0, **settings):
    return Deployment(terrain=Terrain(kind="foam", foam=Foam(**settings)), hw=Hw(seed=seed))


def pads(model):
    """(x, y) and stiffness of every pad."""
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    joints = [model.joint(i) for i in range(model.njnt)]
    return {j.name: (*data.body(j.name).xpos[:2], j.stiffness.ravel()[0]) for j in joints if "pad" in j.name}


@pytest.mark.parametrize("force_n", [40.0, 110.0])
def test_a_pad_sinks_by_force_over_stiffness(force_n):
    drawn = deployment()
    press = PressTest(drawn)
    found = pads(build_scene(drawn, None, 0.6)[0])
    assert len(found) == FOAM.rows * FOAM.columns
    for x, y, stiffness in found.values():
        sunk = press.press(x, y, force_n).displacement_m
        # The one newton with which the sphere rests is sunk already; the contact itself yields a little.
        assert sunk == pytest.approx((force_n - 1.0) / stiffness, rel=0.03, abs=6e-4)


def test_no_pad_counts_as_collapsed_anywhere():
    for seed in range(3):
        drawn = deployment(seed)
        stiffness = np.array([figure[2] for figure in pads(build_scene(drawn, None, 0.6)[0]).values()])
        sinks = 110.0 / stiffness
        assert (sinks >= 0.002 - 1e-12).all() and (sinks <= 0.025 + 1e-12).all()
        assert sinks.max() - sinks.min() > 0.01
    press, field = PressTest(drawn), build_scene(drawn, None, 0.6)[1]
    xs = np.linspace(field.start_x - 0.02, field.end_x + 0.02, 9)
    assert (
        press.label_map(xs, (-0.21, -0.1, 0.0, 0.102, 0.2), 110.0) <= 0.0265
    ).all()  # the contact itself yields too


def test_the_softest_foam_that_can_be_set_still_bears():
    softest = deployment(rows=1, columns=1, sink_min_m=0.025, sink_max_m=0.025)
    ((x, y, _),) = pads(build_scene(softest, None, 0.6)[0]).values()
    assert 0.024 < PressTest(softest).press(x, y, 110.0).displacement_m <= 0.0265


def test_a_pad_does_not_ring():
    model = build_scene(deployment(rows=1, columns=1), None, 0.6)[0]
    data = mujoco.MjData(model)
    data.qpos[0] = -0.015
    heights = []
    for _ in range(400):
        mujoco.mj_step(model, data)
        heights.append(data.qpos[0])
    assert max(heights) < 1e-5, "it comes back without overshoot"
    assert abs(heights[-1]) < 5e-5
