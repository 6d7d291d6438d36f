"""The Tab key: what bash offers is what the parser takes."""

import shutil
import subprocess

import pytest

from surefoot.bus.topics import PROCESSES
from surefoot.tools.cli import main, make_parser
from surefoot.tools.commands.call import deployment_names
from surefoot.tools.completion import script

OFFERS = """
COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); COMPREPLY=()
_shtab_surefoot 2>/dev/null
printf '%s\\n' "${COMPREPLY[@]}"
"""


@pytest.fixture(scope="module")
def offered(tmp_path_factory):
    """What bash completes the last of some words by, in a folder with a recording and a deployment."""
    folder = tmp_path_factory.mktemp("here")
    for name in ("walk.mcap", "mine.toml", "notes.txt"):
        (folder / name).touch()
    program = script(make_parser(), "bash") + OFFERS

    def complete(*words):
        call = ["bash", "-c", program, "bash", "surefoot", *words]
        answer = subprocess.run(call, cwd=folder, capture_output=True, text=True, check=True)
        return set(answer.stdout.split())

    return complete


def test_commands_and_their_verbs(offered):
    assert {"run", "replay", "record", "report", "reproduce", "restart"} >= offered("re") >= {"replay", "record"}
    assert offered("keys", "") == {"init", "show"}


def test_deployments_by_name_or_file(offered):
    assert offered("run", "") == {*deployment_names(), "mine.toml"}
    assert offered("eval", "pl") == {name for name in deployment_names() if name.startswith("pl")}


def test_a_file_where_a_file_is_meant(offered):
    assert offered("info", "") == {"walk.mcap"}
    assert offered("press", "planks", "--out", "") == {"walk.mcap", "mine.toml", "notes.txt"}


def test_choices_and_words(offered):
    assert offered("eval", "flat", "--vision", "") == {"on", "off"}
    assert offered("restart", "") == {*PROCESSES} - {"io"}
    assert "stand" in offered("command", "")


@pytest.mark.parametrize("shell", ["bash", "zsh", "tcsh"])
def test_a_shell_reads_its_script(shell, capsys, tmp_path):
    assert main(["completion", shell]) == 0
    file = tmp_path / "script"
    file.write_text(capsys.readouterr().out)
    assert "planks_emulated" in file.read_text()
    if shutil.which(shell) is None:
        pytest.skip(f"no {shell} on this machine to read it")
    subprocess.run([shell, "-n", file], check=True)
