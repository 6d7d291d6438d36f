"""What each argument of `surefoot` is completed by."""

from __future__ import annotations

import argparse
from pathlib import Path

import shtab

from surefoot.bus.topics import PROCESSES
from surefoot.components.fsm.words import COMMANDS
from surefoot.tools.commands.call import deployment_names

_WORDS = {
    ("surefoot command", "command"): tuple(COMMANDS),
    ("surefoot restart", "name"): tuple(name for name in PROCESSES if name != "io"),
    ("surefoot child", "name"): tuple(PROCESSES),
}
"""Where one of a few words is meant, by command and argument."""

_DEPLOYMENTS = ("config", "scenario", "connect")
"""Arguments that name a deployment."""

_RECORDING = shtab.glob("*.mcap") | {"zsh": "_files -g '*.mcap'"}
"""In brackets, as shtab has it, zsh takes a single pattern for qualifiers and finds no file."""


def script(parser: argparse.ArgumentParser, shell: str) -> str:
    """The completion of a parser for a shell.

    Args:
        parser: of all commands; its arguments are marked with what completes them.
        shell: "bash", "zsh" or "tcsh".
    """
    _mark(parser)
    return shtab.complete(parser, shell)


def _mark(parser: argparse.ArgumentParser) -> None:
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            for inner in action.choices.values():
                _mark(inner)
            continue
        words = _WORDS.get((parser.prog, action.dest))
        if words is not None:
            action.choices = words
        elif action.dest in _DEPLOYMENTS:
            action.complete = _deployment()  # type: ignore[attr-defined]
        elif action.dest == "recording":
            action.complete = _RECORDING  # type: ignore[attr-defined]
        elif action.type is Path:
            action.complete = shtab.FILE  # type: ignore[attr-defined]


def _deployment() -> dict:
    """The deployments that come with the project by their names, any other by its file."""
    names = " ".join(deployment_names())
    bash = f"""
_surefoot_deployment_file() {{
  compgen -W "{names}" -- "$1"
  compgen -f -X '!*.toml' -- "$1"
  compgen -d -- "$1"
}}
"""
    zsh = f"""
_surefoot_deployment_file() {{
  _alternative 'names:deployment:({names})' 'files:file:_files -g "*.toml"'
}}
"""
    return {
        "bash": "_surefoot_deployment_file",
        "zsh": "_surefoot_deployment_file",
        "tcsh": f"`echo {names}`",  # it completes by names or by files, not by both
        "preamble": {"bash": bash, "zsh": zsh},
    }
