"""Starts the processes of a run, each with a log of its own and in the guardian's care, and ends them."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Literal

from surefoot.tools.guardian import Guardian

KILL_AFTER_S = 3.0
"""A process that has not ended so long after it was told to is killed: a stop takes at most this for each."""


class Launcher:
    """Starts processes of one deployment as children of this one."""

    def __init__(self, config: Path, settings: Sequence[str], log_dir: Path):
        """For a deployment.

        Args:
            config: its file.
            settings: assignments on top of it.
            log_dir: where each process's log goes.
        """
        self._config, self._log_dir = config, log_dir
        self._settings = [word for setting in settings for word in ("--set", setting)]
        self._guardian: Guardian | None = None

    def open(self) -> None:
        """Make room for the logs and start the guardian: what is launched from now on has it.

        The file is copied there: a process that is restarted reads what the others have read, whoever has changed
        the original since.
        """
        self._log_dir.mkdir(parents=True, exist_ok=True)
        text = self._config.read_bytes()
        self._config = self._log_dir / "deployment.toml"
        self._config.write_bytes(text)
        self._guardian = Guardian(self.log_of("supervisor"))

    def close(self) -> None:
        """All has ended in order: the guardian ends too."""
        if self._guardian is not None:
            self._guardian.close()
            self._guardian = None

    def launch(self, name: str, boot: int, *words: str) -> subprocess.Popen:
        """Start a process of the deployment.

        Args:
            name: of the process.
            boot: of its messages.
            words: more of `surefoot child`'s arguments.
        """
        arguments = ["child", str(self._config), name, *self._settings, "--boot", str(boot), *words]
        popen = start_child(arguments, self.log_of(name), "ab")
        self.watch(popen.pid, name)
        return popen

    def watch(self, pid: int, name: str) -> None:
        """Give a process that has just been started into the guardian's care."""
        if self._guardian is not None:
            self._guardian.watch(pid, name)

    def log_of(self, name: str) -> Path:
        """Where a process's output goes."""
        return self._log_dir / f"{name}.log"

    def note(self, words: str) -> None:
        """Write a line into the supervisor's own log."""
        self._log_dir.mkdir(parents=True, exist_ok=True)
        with self.log_of("supervisor").open("a") as log:
            log.write(f"{words}\n")

    def obituary(self, name: str, code: int) -> str:
        """How a process ended, in words."""
        how = f"signal {-code}" if code < 0 else f"exit code {code}"
        log = self.log_of(name)
        lines = log.read_text(errors="replace").strip().splitlines() if log.exists() else []
        last = f" ({lines[-1][:160]})" if lines and code > 0 else ""
        return f"{name} ended with {how}{last}, see {log}"


def start_child(arguments: Sequence[str], log: Path, mode: Literal["ab", "wb"] = "wb") -> subprocess.Popen:
    """Start a command of `surefoot` that ends with this process; its log goes on ("ab") or begins anew ("wb")."""
    command = [sys.executable, "-P", "-m", "surefoot.tools.cli", *arguments, "--parent", str(os.getpid())]
    with log.open(mode) as output:
        # A session of its own: Ctrl-C reaches the supervisor alone, which ends all in order.
        return subprocess.Popen(
            command, stdout=output, stderr=output, stdin=subprocess.DEVNULL, start_new_session=True
        )


def end_process(popen: subprocess.Popen | None) -> None:
    """End a process, by force if it does not."""
    if popen is None or popen.poll() is not None:
        return
    popen.terminate()
    popen.send_signal(signal.SIGCONT)  # one that is stopped can still end in order
    try:
        popen.wait(KILL_AFTER_S)
    except subprocess.TimeoutExpired:
        popen.kill()
        popen.wait()
