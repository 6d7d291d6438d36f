"""A standing robot in lockstep whose whole-body controller is away for half a second: it lies until it is told."""

from surefoot.components.lockstep import Lockstep
from surefoot.components.wbc.wbc import Wbc
from surefoot.config.deployment import Deployment
from surefoot.config.mpc import Mpc

GONE_S, BACK_S = 1.0, 1.5


class AwayWbc(Wbc):
    """Skips every step between the two."""

    def step(self, t, inbox, outbox):
        if not GONE_S <= t < BACK_S:
            super().step(t, inbox, outbox)


def test_a_controller_that_comes_back_to_a_sunk_robot_moves_it_only_after_sit_and_stand():
    deployment = Deployment(mpc=Mpc(profile="light"))
    stack = Lockstep(deployment, given=[AwayWbc(deployment)])
    log = {"sim/truth": [], "hw/state": [], "fsm/reference": []}
    stack.listen(lambda key, message: log[key].append(message) if key in log else None)

    def height():
        return log["sim/truth"][-1].p_WB[2]

    stack.command("stand")
    stack.run(GONE_S)
    assert height() > 0.37
    stack.run(2.0)
    sunk = height()
    stack.command("stand")  # for the state machine it stands
    stack.run(3.0)
    assert height() <= sunk < 0.2 and max(abs(each.v_WB_W[2]) for each in log["sim/truth"][-500:]) < 0.1
    state = log["hw/state"][-1]
    assert state.damping and "is wbc running?): command sit, or damp, then stand" in state.gate

    stack.command("sit")
    stack.run(10.0, lambda: log["fsm/reference"][-1].state == "DAMP")
    stack.run(stack.t + 0.1)
    assert not log["hw/state"][-1].damping
    stack.command("stand")
    stack.run(10.0, lambda: log["fsm/reference"][-1].state == "STAND" and height() > 0.37)
    assert height() > 0.37 and log["hw/state"][-1].gate == ""
