"""The Tab key: what the shells offer is what the parser takes."""

import os
import pty
import select
import shutil
import subprocess
import time

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


def typed(shell, setup, line, awaited, folder):
    """What a shell on a terminal shows of a line with its tabs, until it shows what is awaited."""
    ours, its = pty.openpty()
    process = subprocess.Popen(shell, cwd=folder, stdin=its, stdout=its, stderr=its, start_new_session=True)
    shown, end = "", time.monotonic() + 20.0
    os.write(ours, f"{setup}; echo re''ady\n".encode())
    try:
        while awaited not in shown and time.monotonic() < end:
            if select.select([ours], [], [], 0.1)[0]:
                shown += os.read(ours, 4096).decode(errors="replace")
            if "\nready" in shown.replace("\r", ""):
                shown = ""
                os.write(ours, line.encode())
    finally:
        process.kill()
        process.wait()
        os.close(ours)
        os.close(its)
    return shown


@pytest.mark.skipif(shutil.which("zsh") is None, reason="no zsh on this machine to type into")
@pytest.mark.parametrize(
    ("line", "awaited"), [("surefoot info \t", "walk.mcap"), ("surefoot eval --vis\t", "--vision")]
)
def test_zsh_completes_what_is_typed(line, awaited, tmp_path):
    (tmp_path / "walk.mcap").touch()
    (tmp_path / "_surefoot").write_text(script(make_parser(), "zsh"))
    setup = f"surefoot() {{ }}; fpath=({tmp_path} $fpath); autoload -U compinit; compinit -u -d {tmp_path}/dump"
    assert awaited in typed(["zsh", "-f", "-i"], setup, line, awaited, tmp_path)
