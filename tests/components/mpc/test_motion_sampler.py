"""What the state machine asks, at the nodes of the MPC's problem."""

import numpy as np

from surefoot.bus.messages import MotionReference
from surefoot.components.mpc.motion_sampler import MotionSampler
from surefoot.config.robot import load_robot


def test_a_heading_that_passes_pi_turns_the_nearer_way():
    sampler = MotionSampler(load_robot("aliengo"), 40, 0.015)
    start, end = np.array([0.0, 0.0, 0.4, 0.0, 0.0, np.pi - 0.1]), np.array([0.1, 0.0, 0.4, 0.0, 0.0, 0.1 - np.pi])
    feet = start[:3] + np.array([[x, y, -0.4] for x in (0.24, -0.24) for y in (0.14, -0.14)])
    asked = {
        "base_from": start,
        "base_to": end,
        "base_t1": 0.5,
        "p_WF": feet,
        "normal_W": np.array([0.0, 0.0, 1.0]),
    }
    nodes = sampler.sample(MotionReference(**asked), 0.0)
    heading = np.unwrap(np.arctan2(nodes.R_WB[:, 1, 0], nodes.R_WB[:, 0, 0]))
    assert (np.diff(heading) > -1e-12).all()
    np.testing.assert_allclose(heading[[0, -1]], [np.pi - 0.1, np.pi + 0.1])
