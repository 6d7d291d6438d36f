"""A robot in lockstep whose whole-body controller is away for half a second: it lies until it is told."""

import pytest

from surefoot.components.lockstep import Lockstep
from surefoot.components.wbc.wbc import Wbc
from surefoot.config.deployment import Deployment
from surefoot.config.mpc import Mpc

AWAY_S = 0.5


class AwayWbc(Wbc):
    """Skips every step from `gone_s` on until it is back."""

    gone_s = 1e9

    def step(self, t, inbox, outbox):
        if not self.gone_s <= t < self.gone_s + AWAY_S:
            super().step(t, inbox, outbox)


class Stack:
    """Standing, or on its way to where the base shifts for the first step; then the controller goes.

    Attributes:
        log: all that matters here.
    """

    def __init__(self, command, until):
        deployment = Deployment(mpc=Mpc(profile="light"))
        wbc = AwayWbc(deployment)
        self.stack = Lockstep(deployment, given=[wbc])
        self.log = {"sim/truth": [], "hw/state": [], "fsm/reference": []}
        self.stack.listen(lambda key, message: self.log[key].append(message) if key in self.log else None)
        self.stack.command(command)
        self.stack.run(10.0, lambda: self.state == until)
        self.go_on(0.2)
        assert self.height > 0.37
        wbc.gone_s = self.stack.t
        self.go_on(1.5)

    @property
    def state(self):
        return self.log["fsm/reference"][-1].state if self.log["fsm/reference"] else ""

    @property
    def height(self):
        return self.log["sim/truth"][-1].p_WB[2]

    @property
    def hardware(self):
        return self.log["hw/state"][-1]

    def go_on(self, seconds, until=lambda: False):
        self.stack.run(self.stack.t + seconds, until)


@pytest.mark.parametrize(("command", "until"), [("stand", "STAND"), ("forward", "MOVE")])
def test_a_controller_that_comes_back_to_a_sunk_robot_moves_it_only_after_sit_and_stand(command, until):
    robot = Stack(command, until)
    sunk = robot.height
    robot.stack.command("stand")  # for the state machine it stands, or a leg is on its way back
    robot.go_on(1.0)
    assert robot.height <= sunk < 0.2
    assert max(abs(each.v_WB_W[2]) for each in robot.log["sim/truth"][-500:]) < 0.1
    assert robot.hardware.damping and "command sit, or damp, then stand" in robot.hardware.gate

    robot.stack.command("sit")
    robot.go_on(10.0, lambda: robot.state == "DAMP")
    robot.go_on(5.0)  # it lies long enough for a drift to matter
    assert robot.state == "DAMP" and not robot.hardware.damping
    robot.stack.command("stand")
    robot.go_on(5.0, lambda: robot.state == "STAND")
    robot.go_on(2.0)
    assert robot.state == "STAND" and robot.height > 0.37 and robot.hardware.gate == ""
