"""The ideal estimator says what is true, of the cycle in which it is asked."""

import numpy as np
import pytest

from surefoot.components.lockstep import Lockstep
from surefoot.components.registry import component_class
from surefoot.config.deployment import Deployment
from surefoot.config.mpc import Mpc
from surefoot.tools.evaluation.true_state import TrueState


@pytest.fixture(scope="module")
def told():
    """Truth and estimate of every cycle while the robot starts to walk: every foot has moved."""
    deployment = Deployment(mpc=Mpc(profile="light"))
    stack = Lockstep(deployment, given=[TrueState(deployment)])
    log = {"sim/truth": [], "state/estimate": []}
    stack.listen(lambda key, message: log[key].append(message) if key in log else None)
    stack.command("forward")
    stack.run(2.6)  # one foot has been lifted and set down
    return log["sim/truth"], log["state/estimate"]


def test_it_has_the_name_and_the_messages_of_the_real_one():
    real = component_class("estimator")
    assert TrueState.name == real.name and TrueState.outputs == real.outputs


def test_every_cycle_has_its_own_truth(told):
    truths, estimates = told
    assert len(estimates) >= len(truths) - 1
    for truth, estimate in zip(truths, estimates, strict=False):
        assert estimate.t == pytest.approx(truth.t, abs=1e-9) and estimate.valid
        for same in ("p_WB", "quat_WB", "v_WB_W", "omega_WB_B", "q", "dq", "p_WF", "force_W"):
            np.testing.assert_array_equal(getattr(estimate, same), getattr(truth, same), same)


def test_a_foot_is_in_contact_where_the_ground_bears_it(told):
    truths, estimates = told
    contact = np.array([estimate.contact for estimate in estimates])
    assert (~contact).any(axis=0).sum() == 1 and contact[0].all()
    for truth, estimate in list(zip(truths, estimates, strict=False))[
        1:
    ]:  # before the first step nothing is borne
        np.testing.assert_array_equal(estimate.contact, np.linalg.norm(truth.force_W, axis=1) > 1.0)


def test_velocities_are_the_slopes_of_the_positions(told):
    _, estimates = told
    feet = np.array([estimate.p_WF for estimate in estimates])
    speed = np.array([estimate.v_WF for estimate in estimates])
    assert np.abs(speed).max() > 0.3
    slope = (feet[2:] - feet[:-2]) / 0.004
    # An impact between two cycles has no slope: all but a few of them agree.
    off = np.abs(slope - speed[1:-1]).max(axis=(1, 2))
    assert np.percentile(off, 99) < 0.02
    joints = np.array([estimate.q for estimate in estimates])
    rates = np.array([estimate.dq for estimate in estimates])
    assert np.percentile(np.abs((joints[2:] - joints[:-2]) / 0.004 - rates[1:-1]).max(axis=1), 99) < 0.1


def test_on_level_ground_the_normal_is_up(told):
    _, estimates = told
    for estimate in estimates:
        assert estimate.normal_W[2] > np.cos(0.02)


def test_without_truth_it_does_not_begin():
    stack = Lockstep(Deployment(), names=["estimator"], given=[TrueState(Deployment())])
    assert not stack.components["estimator"].activate(0.0, stack.executors["estimator"].inbox)
