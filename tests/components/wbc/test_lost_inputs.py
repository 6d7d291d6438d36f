"""A standing robot in lockstep whose MPC or state machine falls silent, for a while or for good."""

import numpy as np
import pytest
from test_standing import CHAIN, Script

from surefoot.components.component import Component
from surefoot.components.lockstep import Lockstep
from surefoot.components.mpc.mpc import Mpc
from surefoot.config.deployment import Deployment
from surefoot.config.mpc import Mpc as Settings

SILENT_S = 1.0


class SilentMpc(Mpc):
    """Skips every step from 1.0 s on, until `back_s`."""

    back_s = np.inf

    def step(self, t, inbox, outbox):
        if not SILENT_S <= t < self.back_s:
            super().step(t, inbox, outbox)


class BrieflySilentMpc(SilentMpc):
    back_s = 1.8


class LateMpc(SilentMpc):
    back_s = 4.5


class SilentScript(Script):
    def step(self, t, inbox, outbox):
        if t < SILENT_S:
            super().step(t, inbox, outbox)


def run(seconds, *parts: type[Component]):
    deployment = Deployment(mpc=Settings(profile="light"))
    stack = Lockstep(deployment, CHAIN, given=[part(deployment) for part in parts])
    log = {"sim/truth": [], "joint/command": []}
    stack.listen(lambda key, message: log[key].append(message) if key in log else None)
    stack.run(seconds)
    return log["sim/truth"], log["joint/command"]


def test_the_base_is_held_while_the_policy_is_gone_and_its_return_is_no_jump():
    truth, commands = run(3.0, Script, BrieflySilentMpc)
    assert any("no fresh policy" in command.solver for command in commands if command.t > 1.2)
    assert commands[-1].solver == "ok"
    standing = np.array([each.p_WB for each in truth if each.t > 0.9])
    assert np.ptp(standing, axis=0).max() < 0.01
    tau = np.array([command.tau for command in commands if command.t > 1.7])
    assert np.abs(np.diff(tau, axis=0)).max() < 3.0  # sensor noise alone moves a torque by 1 to 2 N m a cycle


@pytest.mark.parametrize("parts", [(Script, SilentMpc), (SilentScript,)], ids=["mpc", "fsm"])
def test_when_it_stays_away_the_robot_is_lowered_gently_and_damped(parts):
    truth, commands = run(5.0, *parts)
    at = {round(each.t, 3): each for each in truth}
    assert at[1.9].p_WB[2] > 0.38
    assert "lowered" in commands[-1].solver and (commands[-1].tau == 0.0).all()
    assert max(np.abs(each.v_WB_W[2]) for each in truth if 1.5 < each.t < 3.5) < 0.2
    assert max(2.0 * np.arccos(min(1.0, abs(each.quat_WB[0]))) for each in truth if each.t < 3.5) < 0.1


def test_a_policy_that_comes_back_too_late_does_not_make_a_lying_robot_leap_up():
    truth, commands = run(6.0, Script, LateMpc)
    lying = [each for each in truth if each.t > LateMpc.back_s]
    assert max(each.p_WB[2] for each in lying) < 0.1
    assert max(np.abs(each.v_WB_W[2]) for each in lying) < 0.3  # a leap is faster than 1.5 m/s
    assert "command sit, then stand" in commands[-1].solver and not commands[-1].tau.any()
