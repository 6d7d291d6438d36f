"""The recorder beside a supervised run: no part of the control chain, which goes on without it."""

from __future__ import annotations

import subprocess
from pathlib import Path

from surefoot.tools.launcher import start_child

NAME = "recorder"
"""Of its log."""

_WRITE_S = 10.0  # it ends by itself after the last process, when it has written what it has
_KILL_AFTER_S = 3.0


class RecorderProcess:
    """`surefoot record` as a child."""

    def __init__(self, path: Path, namespace: str, log: Path):
        """Start recording the stack of a namespace to `path`."""
        self._path, self._log = path, log
        self._popen = start_child(["record", str(path), "--namespace", namespace], log)

    @property
    def pid(self) -> int:
        """Process id."""
        return self._popen.pid

    @property
    def ready(self) -> bool:
        """It records, or has ended."""
        return "recording" in self._log.read_text(errors="replace") or self._popen.poll() is not None

    def end(self) -> None:
        """Let it write what it has, then see that it is gone."""
        for wait_s, then in ((_WRITE_S, self._popen.terminate), (_KILL_AFTER_S, self._popen.kill)):
            try:
                self._popen.wait(wait_s)
                return
            except subprocess.TimeoutExpired:
                then()
        self._popen.wait()

    def obituary(self) -> str:
        """How it has ended, in words; empty while it goes on."""
        code = self._popen.poll()
        if code is None:
            return ""
        lines = self._log.read_text(errors="replace").strip().splitlines()
        if code == 0:
            return lines[-1]
        how = f"signal {-code}" if code < 0 else lines[-1] if lines else f"exit code {code}"
        return f"the recorder has ended: {how}; see {self._log}, `surefoot info {self._path}`"
