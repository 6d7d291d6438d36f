"""The stack and the emulated robot over sockets: it gets up and begins to walk although the link is bad."""

from pathlib import Path

import pytest

import surefoot.config.deployment as deployment_module
from surefoot.config.deployment import Deployment, load_deployment
from surefoot.config.typed_toml import ConfigError
from surefoot.tools.emulated_stack import EmulatedStack
from surefoot.tools.emulated_walk import walk

PLANKS = Path(deployment_module.__file__).parent / "planks_emulated.toml"


def test_on_a_bad_link_it_stands_up_swings_a_leg_and_probes():
    done = walk(load_deployment(PLANKS, ["mpc.profile=light"]), 4.6)
    assert done.sound, str(done)
    assert done.counts["contact"] >= 1 and done.counts["force_held"] >= 1 and done.witness.tilt < 0.1
    assert 0.005 < done.link.loss < 0.1 and done.link.commands == pytest.approx(4.6 * 500, abs=20)


def test_a_deployment_that_does_not_wait_for_its_robot_is_refused():
    with pytest.raises(ConfigError, match=r"hw\.backend = 'mujoco' .* as in config/planks_emulated\.toml"):
        EmulatedStack(Deployment())
    with pytest.raises(ConfigError, match=r"emulator\.pace = 'wall'"):
        EmulatedStack(load_deployment(PLANKS, ["emulator.pace=wall"]))
