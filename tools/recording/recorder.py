"""The recorder's process: takes the journals of a running stack and writes them to one file."""

from __future__ import annotations

import math
import queue
import shutil
import time
from collections.abc import Callable
from pathlib import Path

from surefoot.bus.errors import BusError, MessageError, RecordingError
from surefoot.bus.recording.journal import Batch
from surefoot.bus.recording.writer import RecordingWriter
from surefoot.bus.service_keys import LOG
from surefoot.bus.session import Session
from surefoot.components.deployment_desk import ask_deployment
from surefoot.tools.recording.about import about

_LOOK_S = 0.05
_FLUSH_S = 0.4
_PATIENCE_S = 0.5  # a batch that is not there by then is asked for
_ANSWER_S = 1.0  # meanwhile nothing is written
_GIVE_UP_S = 10.0  # a little longer than a process keeps a batch
_BEGINNING = 30  # batches: who has just started keeps all of them, and all are wanted; else those to come
_HUB_S = 60.0
_FREE_BYTES = 200_000_000


class _Source:
    """One start of one process: which of its batches have come."""

    def __init__(self, begin: int) -> None:
        self.next = begin
        self.early: dict[int, Batch] = {}
        self.missed_since = self.ask_at = 0.0
        self.ended = False

    def ready(self) -> list[Batch]:
        """The batches that follow those before, in order."""
        batches = []
        while self.next in self.early:
            batches.append(self.early.pop(self.next))
            self.next += 1
        return batches


class Recorder:
    """Writes every batch once, in order; one that did not come is asked for, one that cannot be had is told.

    Attributes:
        lost: in words, batches that nobody has any more.
        cpu_s: once it is over: processor time since it began to wait for batches [s].
    """

    def __init__(self, session: Session, path: Path, how: str = "record"):
        """Begin the file.

        Raises:
            BusError: the stack does not say what is running.
            RecordingError: the file cannot be made.
        """
        self._session, self._path = session, path
        self.lost: list[str] = []
        self.cpu_s = 0.0
        self._first_ns, self._last_ns = math.inf, 0.0  # on the run's clock
        self._arrived: queue.SimpleQueue[bytes] = queue.SimpleQueue()
        self._sources: dict[tuple[str, int], _Source] = {}
        session.subscribe(f"{LOG}/*", lambda key, payload: self._arrived.put(payload))
        try:
            self._writer = RecordingWriter(path, about(ask_deployment(session), how))
        except OSError as error:
            raise RecordingError(f"cannot write {path}: {error.strerror}") from None
        self._flushed = time.monotonic()

    def run(self, due: Callable[[], bool]) -> None:
        """Until `due()`, or until every process has ended; then close the file.

        Raises:
            RecordingError: the disk is full, or cannot be written; what was flushed stands.
        """
        cpu_s = time.process_time()
        try:
            while not due() and not self._all_ended():
                self._take(_LOOK_S)
                self._repair()
                if time.monotonic() - self._flushed > _FLUSH_S:
                    self._writer.flush()
                    self._flushed = time.monotonic()
            self._take(0.0)
            self._give_up()
            self._writer.close()
        except OSError as error:
            self._writer.abandon()
            raise RecordingError(
                f"recording ended: {self._path}: {error.strerror}; it can be read up to the last half second "
                "(`surefoot info`), and the run goes on without it: free some space and `surefoot record` again"
            ) from None
        self.cpu_s = time.process_time() - cpu_s

    def summary(self) -> str:
        """What was recorded, once it is over: size, the run's time, and what it has cost."""
        seconds = max(self._last_ns - self._first_ns, 0.0) / 1e9
        return (
            f"recorded {self._path.stat().st_size / 1e6:.1f} MB in {seconds:.1f} s of the run's time, "
            f"{self.cpu_s:.2f} s CPU, to {self._path}"
        )

    def _take(self, wait_s: float) -> None:
        """Write what has arrived."""
        time.sleep(wait_s)  # many at a time are cheaper than each alone
        for _ in range(self._arrived.qsize()):
            try:
                self._sort(Batch.unpack(self._arrived.get()))
            except MessageError as error:
                self.lost.append(str(error))

    def _sort(self, batch: Batch) -> None:
        source = self._sources.get((batch.process, batch.boot))
        if source is None:
            begin = batch.number if batch.number > _BEGINNING else 0
            source = self._sources[batch.process, batch.boot] = _Source(begin)
        if batch.number < source.next:
            return
        source.early[batch.number] = batch
        self._write_ready(source)

    def _repair(self) -> None:
        """Ask the processes for batches that were overtaken by later ones; skip those that nobody has.

        A process that does not answer is busy or stopped: it is asked again as long as it may have them, and
        what comes from the others is written meanwhile.
        """
        due = [(source.ask_at, start) for start, source in self._sources.items() if source.early]
        for ask_at, (process, boot) in sorted(due):
            source = self._sources[process, boot]
            if time.monotonic() < ask_at:
                return
            try:
                self._ask_for_missing(process, boot, source)
            except BusError:
                source.ask_at = time.monotonic() + _PATIENCE_S
                if source.ask_at - source.missed_since < _GIVE_UP_S:
                    return
            if source.early:
                self._skip(process, boot, source)

    def _ask_for_missing(self, process: str, boot: int, source: _Source) -> None:
        for number in range(source.next, min(source.early)):
            payload = self._session.ask_each(f"{LOG}/{process}", number, _ANSWER_S)
            if payload is None:
                continue  # a newer one may still be kept
            batch = Batch.unpack(payload)
            if batch.boot != boot:
                return
            self._sort(batch)

    def _skip(self, process: str, boot: int, source: _Source) -> None:
        first = min(source.early)
        self.lost.append(f"{process}: batches {source.next} to {first - 1} after {boot} restarts")
        source.next, source.missed_since = first, 0.0
        self._write_ready(source)

    def _write_ready(self, source: _Source) -> None:
        """Write what follows; the time of what is missing then begins if it has not."""
        for each in source.ready():
            source.ended = each.last
            self._writer.add(each)
            if each.records:
                self._first_ns = min(self._first_ns, each.records[0][1])
                self._last_ns = max(self._last_ns, each.records[-1][1])
        if not source.early:
            source.missed_since = 0.0
        elif not source.missed_since:
            source.missed_since = time.monotonic()
            source.ask_at = source.missed_since + _PATIENCE_S

    def _give_up(self) -> None:
        """Write what is still there beyond a gap."""
        for (process, boot), source in self._sources.items():
            while source.early:
                self._skip(process, boot, source)

    def _all_ended(self) -> bool:
        """Every process, io among them, has said that it is the end."""
        newest: dict[str, _Source] = {}
        for (process, _), source in sorted(self._sources.items()):
            newest[process] = source
        return "io" in newest and all(source.ended for source in newest.values())


def connect(namespace: str, due: Callable[[], bool]) -> Session:
    """The bus of a namespace for the recorder beside its run: io may be too busy coming up to answer at once.

    Raises:
        BusError: there is none.
    """
    end = time.monotonic() + _HUB_S
    while True:
        try:
            return Session(namespace, connect_ms=1000)
        except BusError:
            if due() or time.monotonic() > end:
                raise


def check_space(path: Path) -> str:
    """A warning if there is little room where `path` is to be; empty if there is enough.

    Raises:
        RecordingError: there is no such folder.
    """
    folder = path.resolve().parent
    if not folder.is_dir():
        raise RecordingError(f"cannot write {path}: there is no folder {folder}; make it first")
    free = shutil.disk_usage(folder).free
    if free < _FREE_BYTES:
        return f"only {free / 1e6:.0f} MB free for {path}: a run takes about 5 MB a second"
    return ""
