"""One process for each run: what kills it costs that run alone."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from multiprocessing import get_context
from multiprocessing.connection import Connection, wait
from multiprocessing.context import SpawnProcess
from typing import cast

from surefoot.components.process_end import ProcessEnd

Work = Callable[..., dict]
"""Makes one entry of `runs` in `results.json`; importable, since a fresh process has to find it."""


def run_apart(work: Work, calls: Sequence[tuple], jobs: int) -> Iterator[tuple[tuple, dict]]:
    """Do `work` for each of `calls`, its arguments, in a process of its own, `jobs` at a time.

    Yields:
        (call, result) as they end; where the work raised or its process died, the result is a failure that says
        so. Left early, the processes that still run are ended.
    """
    context = get_context("spawn")  # a fork would share the solvers' memory, and locks of the parent's threads
    waiting = list(calls)
    running: dict[Connection, tuple[tuple, SpawnProcess]] = {}
    try:
        while waiting or running:
            while waiting and len(running) < jobs:
                call = waiting.pop(0)
                ear, mouth = context.Pipe(duplex=False)
                process = context.Process(target=_tell, args=(mouth, work, call), daemon=True)
                process.start()
                mouth.close()  # the process holds the only one: the ear hears its death
                running[ear] = call, process
            # `wait` takes sockets too; what it returns are some of the ears it was given.
            for ear in cast(list[Connection], wait(list(running))):
                call, process = running.pop(ear)
                yield call, _hear(ear, process)
    finally:
        for _, process in running.values():
            process.kill()
            process.join()


def do_or_tell(work: Work, call: tuple) -> dict:
    """The result of `work(*call)`; what it raises is told as this run's failure."""
    try:
        return work(*call)
    except Exception as error:
        return failed(f"{type(error).__name__}: {error}")


def failed(why: str) -> dict:
    """The entry of a run that has no result."""
    return {"success": False, "failure": f"error: {why}"}


def _tell(mouth: Connection, work: Work, call: tuple) -> None:
    ProcessEnd()  # does not outlive who waits for the result, not even one killed without warning
    mouth.send(do_or_tell(work, call))


def _hear(ear: Connection, process: SpawnProcess) -> dict:
    with ear:
        try:
            result = ear.recv()
        except (EOFError, OSError):
            result = None
    process.join()
    return failed(f"worker died (exit code {process.exitcode})") if result is None else result
