"""The view beside a supervised run: no part of the control chain, which goes on without it."""

from __future__ import annotations

import re
from pathlib import Path

from surefoot.tools.launcher import end_process, start_child


class ViewProcess:
    """`surefoot view` as a child; it ends with this process, however that ends."""

    def __init__(self, namespace: str, port: int, log: Path):
        """Start it for the stack of a namespace, which need not be up yet.

        Args:
            namespace: of the stack.
            port: of the page; 0 any that is free.
            log: where it writes what it says.
        """
        self._log = log
        self._told = self._ended = False
        log.parent.mkdir(parents=True, exist_ok=True)
        self._popen = start_child(["view", "--wait", "--port", str(port), "--namespace", namespace], log)

    @property
    def pid(self) -> int:
        """Process id."""
        return self._popen.pid

    def url(self) -> str:
        """Of its page; empty before there is one."""
        found = re.search(r"(http://\S+);", self._log.read_text(errors="replace"))
        return found[1] if found else ""

    def news(self) -> str:
        """Where its page is, or that it has ended, each said once; empty otherwise."""
        if self._ended:
            return ""
        code = self._popen.poll()
        if code is not None:
            self._ended = True
            return (
                f"the view has ended with exit code {code}, see {self._log}; `surefoot view` shows the run again"
            )
        if self._told or not (url := self.url()):
            return ""
        self._told = True
        return f"view: {url}"

    def __enter__(self) -> ViewProcess:
        return self

    def __exit__(self, *_: object) -> None:
        """End it, by force if it does not."""
        end_process(self._popen)
