"""Keys that would not be accepted, or that others can read, are refused before anything starts."""

import os
import shutil
from dataclasses import replace

import pytest

from surefoot.bus.endpoints import check_keys
from surefoot.bus.errors import BusError
from surefoot.bus.identity import KeysError
from surefoot.bus.session import Session
from surefoot.config.network import Network
from surefoot.tools.cli import main
from surefoot.tools.keys import make_keys

TWO = {"robot": ("io", "estimator", "wbc", "mpc"), "laptop": ("fsm", "trajopt", "elevation_map")}


@pytest.fixture
def mine(keys, tmp_path):
    """A copy of the identities that a test may spoil, and the network of the laptop and of the robot."""
    folder = tmp_path / "mine"
    shutil.copytree(keys, folder)
    laptop = Network(
        hosts=TWO, listen="tls/127.0.0.1:7448", address="127.0.0.1", keys_dir=str(folder), host="laptop"
    )
    return folder, laptop, replace(laptop, host="robot")


def refused(network, words):
    with pytest.raises(KeysError, match=words) as caught:
        check_keys(network)
    assert "PRIVATE KEY" not in str(caught.value)


def test_good_keys_pass_and_a_closed_deployment_needs_none(mine):
    _, laptop, robot = mine
    check_keys(laptop)
    check_keys(robot)
    check_keys(Network(keys_dir="nowhere"))


@pytest.mark.parametrize("file", ["operator.pem", "operator.key", "authority.pem"])
def test_a_missing_file_is_named(mine, file):
    folder, laptop, robot = mine
    (folder / "operator" / file).unlink()
    refused(laptop, rf"operator/{file} is missing: make identities with `surefoot keys init DIR`")
    check_keys(robot)  # each machine needs its own only


@pytest.mark.parametrize("mode", [0o644, 0o640, 0o602])
def test_a_key_that_others_can_read_or_change_is_refused(mine, mode):
    folder, laptop, _ = mine
    (folder / "operator" / "operator.key").chmod(mode)
    refused(laptop, rf"operator\.key has mode {mode:04o}: .*chmod 600")


@pytest.mark.skipif(os.getuid() == 0, reason="root may read everything")
@pytest.mark.parametrize("file", ["operator.pem", "operator.key", "authority.pem"])
def test_a_file_that_this_user_cannot_read_is_named(mine, file):
    folder, laptop, _ = mine
    (folder / "operator" / file).chmod(0)
    refused(laptop, rf"{file} cannot be read by this user: chown it")


def test_what_is_no_key_or_certificate_is_named(mine):
    folder, laptop, robot = mine
    (folder / "operator" / "operator.key").write_text("-----BEGIN PRIVATE KEY-----\nsecret\n")
    refused(laptop, r"operator\.key is not a private key")
    (folder / "robot" / "robot.pem").write_text("nothing")
    refused(robot, r"robot\.pem is not a certificate")


def test_keys_of_two_authorities_or_two_identities_do_not_go_together(mine, tmp_path):
    folder, laptop, _ = mine
    make_keys(tmp_path / "other", ["127.0.0.1"], 1)
    other = tmp_path / "other" / "operator"
    shutil.copy(other / "authority.pem", folder / "operator" / "authority.pem")
    refused(laptop, r"operator\.pem is not signed by .*authority\.pem")
    shutil.copy(other / "operator.key", folder / "operator" / "operator.key")
    refused(laptop, r"operator\.key does not belong to .*operator\.pem")


def test_another_identity_under_this_name_is_told(mine):
    folder, laptop, _ = mine
    for ending in ("pem", "key"):
        shutil.copy(folder / "robot" / f"robot.{ending}", folder / "operator" / f"operator.{ending}")
    refused(laptop, r"operator\.pem is for 'robot', not for 'operator'")


def test_an_expired_certificate_is_told_with_its_date(tmp_path):
    make_keys(tmp_path / "old", ["127.0.0.1"], 0)
    robot = Network(listen="tls/127.0.0.1:7448", address="127.0.0.1", keys_dir=str(tmp_path / "old"))
    refused(robot, r"robot\.pem expired on \d{4}-\d\d-\d\d: make identities")


def test_the_robots_certificate_must_name_its_address(mine):
    _, _, robot = mine
    refused(
        replace(robot, address="10.0.0.7"),
        r"is for localhost, 127\.0\.0\.1, not for network\.address = '10\.0\.0\.7': .*--robot 10\.0\.0\.7",
    )


def test_neither_a_session_nor_a_run_starts_with_them(mine, tmp_path, capsys):
    folder, laptop, robot = mine
    (folder / "operator" / "operator.key").chmod(0o644)
    (folder / "robot" / "robot.key").chmod(0o644)
    with pytest.raises(BusError, match="chmod 600"):
        Session("keys-refused", network=laptop)
    with pytest.raises(BusError, match="chmod 600"):
        Session("keys-refused", hub=True, network=robot)
    config = tmp_path / "net.toml"
    config.write_text(
        f'[terrain]\nkind = "flat"\n[run]\nlog_dir = "{tmp_path}/log"\nnamespace = "keys-refused"\n'
        f'[network]\nlisten = "tls/127.0.0.1:7448"\naddress = "127.0.0.1"\nkeys_dir = "{folder}"\n'
    )
    assert main(["run", str(config), "--plain"]) == 2
    assert "chmod 600" in capsys.readouterr().err
    assert not (tmp_path / "log").exists()
