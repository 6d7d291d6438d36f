"""Which settings all processes of a run must have alike, and how they are told apart."""

import dataclasses
import json

import pytest

from surefoot.config.deployment import Deployment, load_deployment
from surefoot.config.shared_settings import differences, settings_digest
from surefoot.config.typed_toml import to_table
from surefoot.tools.commands.call import deployment_file

FLAT = deployment_file("flat")


@pytest.mark.parametrize(
    "own",
    [
        "run.log_dir=elsewhere",
        "run.epoch_s=12.5",
        "run.command=stand",
        "run.cores_min=1",
        "network.keys_dir=mine",
        "network.listen=tls/0.0.0.0:7448",
        "network.address=dog.local",
        "network.host=operator",
        "doctor.tilt_max=0.2",
    ],
)
def test_what_is_a_machines_own_does_not_count(own):
    assert settings_digest(load_deployment(FLAT, [own])) == settings_digest(load_deployment(FLAT))


@pytest.mark.parametrize(
    "shared",
    ["wbc.kp=41.0", "run.vision=true", "hw.seed=3", "terrain.kind=slope", "mpc.profile=light",
     'network.hosts={a = ["io"], b = ["estimator", "wbc", "mpc", "fsm", "trajopt", "elevation_map"]}'],
)  # fmt: skip
def test_all_else_does(shared):
    settings = [shared, "network.listen=tls/0.0.0.0:7448", "network.address=dog.local"]
    assert settings_digest(load_deployment(FLAT, settings)) != settings_digest(load_deployment(FLAT))


def test_in_real_time_the_profile_of_the_mpc_is_up_to_its_machine():
    paper, light = (
        load_deployment(FLAT, ["run.clock=monotonic", f"mpc.profile={profile}"]) for profile in ("paper", "light")
    )
    assert settings_digest(paper) == settings_digest(light)


def test_what_differs_is_named_with_both_values_also_after_a_way_over_the_bus():
    mine = to_table(load_deployment(FLAT, ["hw.seed=3", "run.log_dir=x"]))
    other = json.loads(json.dumps(to_table(load_deployment(FLAT))))
    assert differences(mine, other) == ["hw.seed = 3, not 0"]
    del other["hw"]["seed"]
    assert differences(mine, other) == ["hw.seed = 3, not known"]


def test_it_is_the_same_in_every_process():
    assert settings_digest(Deployment()) == settings_digest(dataclasses.replace(Deployment()))
    assert len(settings_digest(Deployment())) == 8
