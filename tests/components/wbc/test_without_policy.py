"""The MPC falls silent while a foot is pressed or hops on: the base stays level, is held and lowered."""

import numpy as np
import pytest

from surefoot.components.lockstep import Lockstep
from surefoot.components.mpc.mpc import Mpc
from surefoot.config.deployment import Deployment
from surefoot.config.mpc import Mpc as Settings


class SilentMpc(Mpc):
    """Steps no more from `gone_s` on."""

    gone_s = 1e9

    def step(self, t, inbox, outbox):
        if t < self.gone_s:
            super().step(t, inbox, outbox)


def tilt(truth):
    return 2.0 * np.arccos(min(1.0, np.hypot(truth.quat_WB[0], truth.quat_WB[3])))


@pytest.mark.parametrize("phase", ["PROBE", "PROBE_AROUND"])
def test_the_base_stays_level_and_comes_down(phase):
    deployment = Deployment(mpc=Settings(profile="light"))
    mpc, heard = SilentMpc(deployment), {"sim/truth": []}
    stack = Lockstep(deployment, given=[mpc])
    stack.listen(lambda key, message: heard.setdefault(key, []).append(message))
    stack.command("forward")
    stack.run(10.0, lambda: "fsm/reference" in heard and heard["fsm/reference"][-1].state == phase)
    mpc.gone_s = stack.t + 0.05
    heard["sim/truth"].clear()
    stack.run(mpc.gone_s + 2.5)
    truths = heard["sim/truth"]
    assert max(map(tilt, truths)) < 0.12
    assert truths[0].p_WB[2] > 0.37 and truths[-1].p_WB[2] < 0.30
