"""The processes below this one, and what each of them holds."""

from __future__ import annotations

import os
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

_PROC = Path("/proc")
_COMMANDS = ("run", "emulator", "record")


@dataclass(frozen=True)
class Held:
    """By one process.

    Attributes:
        rss_mb: memory in RAM [MB].
        files: open files, sockets included.
    """

    rss_mb: float
    files: int


def held_below(pid: int) -> dict[str, Held]:
    """What every process holds that descends from one, by its name in the run; Linux only."""
    parents, words = {}, {}
    for entry in _PROC.glob("[0-9]*"):
        with suppress(OSError, IndexError):  # ended meanwhile
            parents[int(entry.name)] = int((entry / "stat").read_text().rsplit(")", 1)[1].split()[1])
            words[int(entry.name)] = (entry / "cmdline").read_text().split("\0")
    found = {}
    for each in parents:
        if _descends(each, pid, parents):
            with suppress(OSError, StopIteration):
                found[_name(each, words.get(each, []))] = _held(each)
    return found


def _descends(pid: int, ancestor: int, parents: dict[int, int]) -> bool:
    while (pid := parents.get(pid, 0)) > 0:
        if pid == ancestor:
            return True
    return False


def _name(pid: int, words: list[str]) -> str:
    if "child" in words:
        return words[words.index("child") + 2]
    for command in _COMMANDS:
        if command in words:
            return {"run": "supervisor"}.get(command, command)
    return "guardian" if "surefoot.tools.guardian" in words else str(pid)


def _held(pid: int) -> Held:
    lines = (_PROC / str(pid) / "status").read_text().splitlines()
    kilobytes = next(int(line.split()[1]) for line in lines if line.startswith("VmRSS"))
    return Held(kilobytes / 1024.0, len(os.listdir(_PROC / str(pid) / "fd")))
