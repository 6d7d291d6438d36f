"""The control chain in lockstep: estimator, MPC and whole-body controller hold the simulated robot up."""

import numpy as np
import pytest

from surefoot.bus.codec import encode
from surefoot.bus.messages import ControlMode, MotionReference
from surefoot.components.component import Component
from surefoot.components.lockstep import Lockstep
from surefoot.config.deployment import Deployment
from surefoot.config.hw import Hw

CHAIN = ("io", "estimator", "wbc", "mpc", "fsm")


class Script(Component):
    """In place of the state machine: hold the posture for 0.2 s, then balance over the measured feet."""

    name = "fsm"
    inputs = ("state/estimate",)
    outputs = ("fsm/reference",)

    def __init__(self, deployment):
        super().__init__(deployment)
        self.stand_q = np.tile(deployment.load_robot().nominal.stand_q, 4)
        self.pose = self.feet = None

    def step(self, t, inbox, outbox):
        estimate = inbox.latest("state/estimate")
        if estimate is None:
            return
        if t < 0.2:
            reference = MotionReference(
                t=t, valid=True, mode=ControlMode.JOINT, joint_from=self.stand_q, joint_to=self.stand_q
            )
        else:
            if self.pose is None:
                self.pose = np.concatenate([estimate.p_WB, np.zeros(3)])
                self.feet = estimate.p_WF
            hold = {"base_from": self.pose, "base_to": self.pose, "p_WF": self.feet}
            up = np.array([0.0, 0.0, 1.0])
            reference = MotionReference(
                t=t, valid=True, mode=ControlMode.BALANCE, normal_W=up, **(hold | self.extra(t))
            )
        outbox.publish("fsm/reference", reference)

    def extra(self, t):
        return {}


def run(seconds, seed=0, script=Script):
    deployment = Deployment(hw=Hw(seed=seed))
    stack = Lockstep(deployment, CHAIN, given=[script(deployment)])
    log = {"sim/truth": [], "joint/command": [], "mpc/policy": [], "state/estimate": []}
    stack.listen(lambda key, message: log[key].append(message) if key in log else None)
    stack.run(seconds)
    return log


@pytest.mark.parametrize("seed", [0, 1])
def test_it_stands_still_on_its_own_feet(seed):
    log = run(2.0, seed)
    assert {command.solver for command in log["joint/command"] if command.t > 0.25} == {"ok"}
    assert all(policy.valid for policy in log["mpc/policy"])
    settled = [truth.p_WB for truth in log["sim/truth"][400:]]
    assert np.ptp(settled, axis=0).max() < 0.02
    truth = log["sim/truth"][-1]
    assert truth.p_WB[2] > 0.37 and truth.body_contact == ""
    assert abs(truth.quat_WB[0]) > 0.999
    asked = np.mean([command.force_W[:, 2] for command in log["joint/command"][-50:]], axis=0)
    given = np.mean([truth.force_W[:, 2] for truth in log["sim/truth"][-100:]], axis=0)
    np.testing.assert_allclose(asked, given, atol=8.0)


def test_the_same_seed_gives_the_same_bytes_and_another_does_not():
    def trace(seed):
        log = run(0.5, seed)
        return b"".join(encode(m, volatile=False) for m in log["joint/command"] + log["mpc/policy"])

    assert trace(3) == trace(3)
    assert trace(3) != trace(4)
