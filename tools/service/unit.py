"""The text of a systemd unit that runs a deployment."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

RT_PRIORITY = 80
"""The highest real-time priority that its processes may ask for; the kernel's own watchdogs have 99."""

_STOP_S = 180  # the robot sits down within `operator.settle_s`, at most 120; then eight processes have 3 s each

_UNIT = """\
# Written by `surefoot service install`; `surefoot service remove` takes it away.
[Unit]
Description=Surefoot, {name}
Wants=network-online.target
After=network-online.target

[Service]
Type=exec
{account}WorkingDirectory={folder}
Environment=PYTHONUNBUFFERED=1
ExecStartPre={call} doctor {config}
ExecStart={call} run {config} --plain
# No restart: a run that has ended has damped the robot, perhaps in mid-step. A person looks before it gets up.
Restart=no
# The supervisor alone is told to stop: it has the robot sit down, then ends the processes in order, hardware last.
# If it is killed they see to the robot and to themselves, which they could not if they were killed with it.
KillMode=process
# What a process that memory ran out for means to the robot is for the supervisor to say.
OOMPolicy=continue
TimeoutStopSec={stop_s}
LimitRTPRIO={rt_priority}
LimitMEMLOCK=infinity
{affinity}
[Install]
WantedBy={target}
"""


@dataclass(frozen=True)
class Service:
    """A deployment as a service.

    Attributes:
        config: its file.
        python: the interpreter of the environment that Surefoot is installed in.
        folder: where it runs: what is relative in the deployment (`run.log_dir`) is relative to it.
        user: of the user's own systemd, which ends when they log out, rather than the machine's.
        cpus: cores that it keeps to, such as "2-5" or "2,3"; empty: any.
        account: whose name it runs under, and whose `surefoot command` reaches it; empty: systemd's own.
    """

    config: Path
    python: Path
    folder: Path
    user: bool = False
    cpus: str = ""
    account: str = ""

    @property
    def name(self) -> str:
        """Of the unit; one for each deployment's name."""
        return f"surefoot-{self.config.stem}.service"

    def text(self) -> str:
        """The unit file; all paths in it are absolute."""
        call = f"{_word(self.python.absolute())} -P -m surefoot.tools.cli"
        return _UNIT.format(
            name=_percent(self.config.name),
            account=f"User={self.account}\n" if self.account else "",
            folder=_percent(str(self.folder.absolute())),
            call=call,
            config=_word(self.config.absolute()),
            stop_s=_STOP_S,
            rt_priority=RT_PRIORITY,
            affinity=f"CPUAffinity={self.cpus}\n" if self.cpus else "",
            target="default.target" if self.user else "multi-user.target",
        )


def _word(path: Path) -> str:
    """One word of a command line."""
    text = _percent(str(path)).replace("\\", "\\\\").replace('"', '\\"').replace("$", "$$")
    return f'"{text}"' if any(mark in text for mark in " \t\\\"'") else text


def _percent(text: str) -> str:
    """A text in which nothing is a specifier."""
    return text.replace("%", "%%")
