"""One process of a supervised run by hand: its supervisor ends its own and leaves this one alone."""

from __future__ import annotations

import os
import queue
import signal
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path

from surefoot.bus.errors import BusError
from surefoot.bus.hub_socket import hub_owner
from surefoot.bus.service_keys import SUPERVISOR_REQUEST
from surefoot.bus.session import Session
from surefoot.tools.other_process import OtherProcess
from surefoot.tools.supervisor_messages import ANSWER, NOTICE, Notice, unpack_answer, unpack_notice

_CONNECT_MS = 10_000
_ANSWER_S = 20.0  # the supervisor may be ending one process and then another
_LOOK_S = 1.0
_GRACE_S = 5.0


def supervised_run(namespace: str) -> Notice | None:
    """What the supervisor of a namespace says of its run; None if none runs there.

    Raises:
        BusError: a hub serves the namespace and does not answer.
    """
    if not hub_owner(namespace):
        return None
    session = Session(namespace, connect_ms=_CONNECT_MS)
    try:
        said = session.ask(NOTICE)
    finally:
        session.close()
    return unpack_notice(said[0]) if said else None


def borrow(namespace: str, name: str, run: Notice) -> int:
    """Have a process of the run lent to this one; the boot to run as.

    Raises:
        BusError: the supervisor does not lend it, or does not answer.
    """
    answers: queue.SimpleQueue[bytes] = queue.SimpleQueue()
    session = Session(namespace, connect_ms=_CONNECT_MS)
    try:
        session.subscribe(f"{ANSWER}/{os.getpid()}", lambda key, payload: answers.put(payload))
        session.put(SUPERVISOR_REQUEST, f"lend {name} {os.getpid()}".encode())
        answer = unpack_answer(answers.get(timeout=_ANSWER_S))
    except queue.Empty:
        raise BusError(
            f"the supervisor, process {run.pid}, has not lent {name} in {_ANSWER_S:.0f} s: see its screen"
        ) from None
    finally:
        session.close()
    if answer.boot < 0:
        raise BusError(answer.words)
    return answer.boot


def run_borrowed(namespace: str, name: str, run: Notice, work: Callable[[int], int]) -> int:
    """Do `work(boot)` in the place of a process of the run; its exit code.

    Ctrl-C ends the work; then the supervisor starts its own process again. When the run is over that is said and
    the work ends, except at a debugger's prompt, which is left to the person who sits there.

    Raises:
        BusError: the supervisor does not lend it, or does not answer.
    """
    supervisor = OtherProcess(run.pid)
    boot = borrow(namespace, name, run)
    print(
        f"{name} is lent by the run of process {run.pid}, {Path(run.config).name}, namespace {namespace}; "
        f"boot {boot}; Ctrl-C gives it back",
        flush=True,
    )
    threading.Thread(target=_see_the_end, args=(supervisor,), daemon=True).start()
    code = work(boot)
    try:
        still = supervised_run(namespace)
    except BusError:
        still = None
    over = still is None or still.ending != ""
    print("the run is over" if over else f"{name} given back: the supervisor starts its own again", flush=True)
    return code


def _see_the_end(supervisor: OtherProcess) -> None:
    """End this process after the supervisor; by force where no person can be at a prompt."""
    while not supervisor.wait(_LOOK_S):
        pass
    print("the run is over: its supervisor has ended", file=sys.stderr, flush=True)
    os.kill(os.getpid(), signal.SIGTERM)
    if not (sys.stdin and sys.stdin.isatty()):
        time.sleep(_GRACE_S)
        os._exit(1)
