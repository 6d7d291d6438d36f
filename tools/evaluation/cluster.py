"""Runs on a Dask cluster instead of this machine: the same processes, spread over its workers."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from concurrent.futures import CancelledError
from uuid import uuid4

from surefoot.config.typed_toml import ConfigError
from surefoot.tools.blas_threads import BLAS_THREADS
from surefoot.tools.evaluation.own_process import run_alone
from surefoot.tools.evaluation.source import source_digest
from surefoot.tools.evaluation.workers import Work, failed

_CONNECT_S = 10.0


def run_on_cluster(work: Work, calls: Sequence[tuple], address: str) -> Iterator[tuple[tuple, dict]]:
    """Do `work` for each of `calls` on the workers of the Dask scheduler at `address`, each in its own process.

    Yields:
        (call, result) as they end; where the work raised or its process or its worker died, the result is a
        failure that says so. Left early, what still runs is ended.

    Raises:
        ConfigError: Dask is not installed, nobody answers at the address, there is no worker, the workers run
            another state of the program, or the cluster goes away.
    """
    try:
        from distributed import Client
    except ImportError:
        raise ConfigError("--dask needs the package distributed: pip install 'surefoot[cluster]'") from None
    try:
        client = Client(address, timeout=_CONNECT_S, set_as_default=False)
    except (OSError, ValueError) as error:
        why = f"no Dask scheduler there ({error}); start one: dask scheduler"
        raise ConfigError(f"--dask {address}: {why}") from None
    with client:
        _check_workers(client, address)
        tasks = _Tasks(client, work, calls)
        try:
            yield from tasks.as_they_end()
        except (OSError, CancelledError, TimeoutError):
            raise ConfigError(
                f"--dask {address}: the cluster went away with {tasks.left} of {len(calls)} runs to do; "
                "call again for what is missing"
            ) from None


class _Tasks:
    """The runs as tasks, no more at a time than the workers have threads.

    A task that waits on a worker for its turn would go down with the run before it.

    Attributes:
        left: runs that have not ended.
    """

    def __init__(self, client, work: Work, calls: Sequence[tuple]):
        self.left = len(calls)
        self._client, self._work = client, work
        # Over how many threads a sum is split decides its last digits: a run there must not differ from one here.
        self._threads = {name: os.environ.get(name, "1") for name in BLAS_THREADS}
        self._waiting = list(calls)
        self._running: dict[object, tuple] = {}

    def as_they_end(self) -> Iterator[tuple[tuple, dict]]:
        """(call, result) of every run."""
        from distributed import as_completed

        ended = as_completed(self._submit(), loop=self._client.loop)
        for future in ended:
            call = self._running.pop(future)
            result = self._result(future)
            self.left -= 1
            yield call, result
            for submitted in self._submit():
                ended.add(submitted)

    @staticmethod
    def _result(future) -> dict:
        try:
            return future.result()
        except CancelledError:
            raise
        except Exception as error:  # this run's alone: its worker was killed
            return failed(f"{type(error).__name__}: {error}")

    def _submit(self) -> list:
        """Give every free thread of the cluster, which may grow, a run."""
        slots = max(1, sum(self._client.nthreads().values()))
        submitted = []
        while self._waiting and len(self._running) < slots:
            call = self._waiting.pop(0)
            key = f"surefoot-{uuid4().hex}"
            future = self._client.submit(_on_worker, self._work, call, self._threads, key, key=key, pure=False)
            self._running[future] = call
            submitted.append(future)
        return submitted


def _check_workers(client, address: str) -> None:
    try:
        client.wait_for_workers(1, timeout=_CONNECT_S)
    except TimeoutError:
        raise ConfigError(f"--dask {address}: it has no worker; start some: dask worker {address}") from None
    remedy = "install this state of it there, with the extra `cluster`"
    try:
        digests = client.run(source_digest)
    except Exception as error:  # whatever keeps the program from being imported there
        raise ConfigError(f"--dask {address}: the workers cannot import surefoot ({error}); {remedy}") from None
    mine = source_digest()
    others = [worker for worker, digest in digests.items() if digest != mine]
    if others:
        raise ConfigError(f"--dask {address}: {', '.join(others)} run another state of surefoot; {remedy}")


def _on_worker(work: Work, call: tuple, threads: dict[str, str], key: str) -> dict:
    """One run, as a task of a Dask worker."""
    from distributed import get_worker

    tasks = get_worker().state.tasks
    return run_alone(work, call, threads, lambda: key in tasks and tasks[key].state == "executing")
