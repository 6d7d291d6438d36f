"""`surefoot keys`: private from the first byte on, never overwritten, never printed, never in a repository."""

import os
import shutil
import stat
import subprocess
from datetime import UTC, datetime, timedelta

import pytest

from surefoot.tools.cli import main
from surefoot.tools.keys import make_keys, shown


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    made = tmp_path_factory.mktemp("made") / "keys"
    before = os.umask(0)  # the modes do not lean on it
    try:
        make_keys(made, ["robot.local", "10.0.0.1", "fe80::1"], 30)
    finally:
        os.umask(before)
    return made


def files(folder):
    return sorted(str(path.relative_to(folder)) for path in folder.rglob("*") if path.suffix in (".key", ".pem"))


def test_each_machine_gets_its_own_key_and_neither_the_authoritys(folder):
    assert files(folder) == [
        "authority/authority.key",
        "authority/authority.pem",
        "operator/authority.pem",
        "operator/operator.key",
        "operator/operator.pem",
        "robot/authority.pem",
        "robot/robot.key",
        "robot/robot.pem",
    ]


def test_only_their_owner_may_read_them(folder):
    for path in [folder, *folder.rglob("*")]:
        mode = stat.S_IMODE(path.stat().st_mode)
        if path.is_dir():
            assert mode == 0o700, path
        elif path.suffix in (".key", ".pem"):
            assert mode == 0o600, path


def test_nothing_is_overwritten(folder, capsys):
    before = (folder / "robot" / "robot.key").read_bytes()
    assert main(["keys", "init", str(folder)]) == 2
    assert "nothing is overwritten" in capsys.readouterr().err
    assert (folder / "robot" / "robot.key").read_bytes() == before


def test_a_key_is_never_printed(tmp_path, capsys):
    made = tmp_path / "keys"
    assert main(["keys", "init", str(made), "--robot", "10.0.0.1"]) == 0
    assert main(["keys", "show", str(made)]) == 0
    said = capsys.readouterr()
    for path in made.rglob("*.key"):
        lines = path.read_text().splitlines()
        assert len(lines) > 2
        assert not any(line in said.out + said.err for line in lines)
    assert f"to the robot's computer:     {made}/robot/     (reached by 10.0.0.1)" in said.out
    assert f"to the operator's computer:  {made}/operator/" in said.out
    assert f"keep apart, on neither:      {made}/authority/" in said.out


def test_what_is_shown_is_what_was_made(folder, capsys):
    robot, operator = shown(folder)
    assert (robot.name, operator.name) == ("robot", "operator")
    assert robot.addresses == ["robot.local", "10.0.0.1", "fe80::1"]
    assert robot.authority == operator.authority and len(robot.authority) == 16
    for identity in (robot, operator):
        assert timedelta(29) < identity.until - datetime.now(UTC) <= timedelta(30)
        assert identity.trouble == ""
    assert main(["keys", "show", str(folder)]) == 0
    assert "robot: valid until" in capsys.readouterr().out


def test_on_each_machine_its_own_identity_is_shown_and_what_is_wrong_with_it(folder, tmp_path, capsys):
    shutil.copytree(folder / "operator", tmp_path / "operator")
    assert main(["keys", "show", str(tmp_path)]) == 0
    assert "robot:" not in capsys.readouterr().out
    (tmp_path / "operator" / "operator.key").chmod(0o644)
    assert main(["keys", "show", str(tmp_path)]) == 1
    assert "operator: cannot be used" in (said := capsys.readouterr().out) and "chmod 600" in said
    assert main(["keys", "show", str(tmp_path / "empty")]) == 2
    assert "surefoot keys init" in capsys.readouterr().err


def test_a_repository_does_not_take_them_up_wherever_they_are(tmp_path):
    subprocess.run(["git", "init", "-q", str(tmp_path)], check=True)
    make_keys(tmp_path / "some" / "where", ["10.0.0.1"], 1)
    shutil.copytree(tmp_path / "some" / "where" / "robot", tmp_path / "robot")  # as it is copied to its machine
    (tmp_path / "other").write_text("")
    seen = subprocess.run(
        ["git", "-C", str(tmp_path), "status", "--porcelain", "-uall"], check=True, capture_output=True, text=True
    )
    assert seen.stdout.split() == ["??", "other"]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--days", "0"], "--days 0: allowed 1 to 3650"),
        (["--robot", "tls/10.0.0.1"], "--robot 'tls/10.0.0.1': a host name or an IP address"),
        (["--robot", "a b"], "--robot 'a b'"),
    ],
)
def test_a_wrong_call_makes_nothing(words, said, tmp_path, capsys):
    assert main(["keys", "init", str(tmp_path / "keys"), *words]) == 2
    assert said in capsys.readouterr().err
    assert not (tmp_path / "keys").exists()
