"""A small process that outlives its supervisor by some seconds, to end what that one could not.

A process of the run sees by itself that its supervisor is gone, lets go of the robot and ends. One that is
stopped, or hangs in a library that lets no other thread run, sees nothing. The guardian reads the run's process
ids from a pipe, whose end comes when the supervisor's does, however it ends.
"""

from __future__ import annotations

import signal
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path

from surefoot.tools.other_process import OtherProcess

GRACE_S = 5.0
"""After the supervisor's end a process has this long to end by itself; longer than its own last resort."""


class Guardian:
    """The supervisor's end of the pipe."""

    def __init__(self, log: Path, grace_s: float = GRACE_S):
        """Start it; what it has to do by force it says in `log`."""
        command = [sys.executable, "-P", "-m", __spec__.name, repr(grace_s)]
        with log.open("ab") as output:
            # A session of its own: no Ctrl-C and no closed terminal reaches it.
            self._popen = subprocess.Popen(
                command, stdin=subprocess.PIPE, stdout=output, stderr=output, start_new_session=True
            )

    def watch(self, pid: int, name: str) -> None:
        """Have an eye on a process; it must not have been waited for yet."""
        pipe = self._popen.stdin
        if pipe is not None:
            with suppress(BrokenPipeError):  # somebody has ended it: the processes still see to themselves
                pipe.write(f"{pid} {name}\n".encode())
                pipe.flush()

    def close(self) -> None:
        """All has ended in order: it has nothing to do and ends."""
        if self._popen.stdin is not None:
            with suppress(BrokenPipeError):
                self._popen.stdin.close()
        self._popen.wait()


def main(grace_s: float) -> None:
    """Read ids until the pipe ends, then see that none of those processes is left."""
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.SIG_IGN)
    wards: dict[str, OtherProcess] = {}
    for line in sys.stdin:
        pid, _, name = line.strip().partition(" ")
        # The one of that name before it has been waited for by the supervisor.
        if name in wards:
            wards.pop(name).close()
        with suppress(ProcessLookupError):
            wards[name] = OtherProcess(int(pid))
    for ward in wards.values():
        ward.signal(signal.SIGCONT)  # one that is stopped can end by itself too
    end = time.monotonic() + grace_s
    for name, ward in wards.items():
        if not ward.wait(max(end - time.monotonic(), 0.0)):
            ward.signal(signal.SIGKILL)
            print(f"the supervisor is gone and {name} did not end in {grace_s:g} s: killed", flush=True)


if __name__ == "__main__":
    main(float(sys.argv[1]))
