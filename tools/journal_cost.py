"""What a recording costs, at the full rate of the robot: journals in the processes, and the recorder."""

from __future__ import annotations

import multiprocessing
import queue
import time
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from multiprocessing.synchronize import Event
from pathlib import Path
from typing import Any

from surefoot.bus.errors import BusError
from surefoot.bus.message import Message
from surefoot.bus.recording.journal import CHECKPOINT_S, Journal
from surefoot.bus.service_keys import LOG
from surefoot.bus.session import Session
from surefoot.components.clock_messages import pack_snapshot
from surefoot.components.deployment_desk import serve_deployment
from surefoot.components.lockstep import Lockstep
from surefoot.config.deployment import Deployment
from surefoot.tools.recording.recorder import Recorder

_BATCH_S = 0.1  # of the run's time: how often a journal is handed over at full rate
_SNAPSHOTS = 20
_PATIENCE_S = 120.0


class Tape(Journal):
    """Remembers what a process tells its journal, so that this can be told again to one that is measured.

    Attributes:
        calls: of each call the run's time [s], the method's name and its arguments.
    """

    def __init__(self, process: str, inputs: tuple[str, ...]):
        super().__init__(process, inputs)
        self.process, self.inputs = process, inputs
        self.calls: list[tuple[float, str, tuple[Any, ...]]] = []

    def note_step(self, t: float, new: Iterable[Iterable[Message]]) -> None:
        self.calls.append((t, "note_step", (t, [list(messages) for messages in new])))

    def note_message(self, t: float, key: str, seq: int, payload: bytes) -> None:
        self.calls.append((t, "note_message", (t, key, seq, payload)))

    def note_checkpoint(
        self,
        t: float,
        state: bytes,
        latest: Mapping[str, Message | None],
        sent: Mapping[str, int],
        boot: int,
        active: bool,
        fresh: bool = False,
    ) -> None:
        self.calls.append((t, "note_checkpoint", (t, state, dict(latest), dict(sent), boot, active, fresh)))
        super().note_checkpoint(t, state, latest, sent, boot, active, fresh)  # so that it knows when one is due
        self.take()

    def messages(self) -> dict[str, list[bytes]]:
        """The bytes of every message, by topic."""
        found: dict[str, list[bytes]] = {}
        for _, name, arguments in self.calls:
            if name == "note_message":
                found.setdefault(arguments[1], []).append(arguments[3])
        return found


@dataclass(frozen=True)
class Written:
    """What the journals of a stack hand over.

    Attributes:
        seconds: of the run's time.
        batches: when each is due [s], its process, its number and its bytes, in order of time.
        cpu: share of a core that noting and packing takes, by process; at full rate.
    """

    seconds: float
    batches: list[tuple[float, str, int, bytes]]
    cpu: dict[str, float]


def tapes(stack: Lockstep) -> list[Tape]:
    """Give every process of a stack, which has not stepped yet, such a journal."""
    made = []
    for name, executor in stack.executors.items():
        executor.journal = Tape(name, executor.component.inputs)
        made.append(executor.journal)
    return made


def write_journals(stack: Lockstep, recorded: Iterable[Tape]) -> Written:
    """Tell journals what the tapes hold, with ten batches for each second of the run.

    Args:
        stack: whose components' states are what is packed at each checkpoint.
        recorded: its tapes.
    """
    batches: list[tuple[float, str, int, bytes]] = []
    cpu = {}
    for tape in recorded:
        journal, due, number = Journal(tape.process, tape.inputs), _BATCH_S, 0
        begun = time.process_time()
        for t, name, arguments in tape.calls:
            while t >= due:
                payload = journal.take_packed()
                if payload is not None:
                    batches.append((due, tape.process, number, payload))
                    number += 1
                due += _BATCH_S
            getattr(journal, name)(*arguments)
            if name == "note_step":
                journal.batch_is_due()
        payload = journal.take_packed(last=True)
        cpu_s = time.process_time() - begun
        if payload is not None:
            batches.append((due, tape.process, number, payload))
        cpu[tape.process] = cpu_s / stack.t + _snapshot_s(stack, tape.process) / CHECKPOINT_S
    return Written(stack.t, sorted(batches), cpu)


def _snapshot_s(stack: Lockstep, name: str) -> float:
    """CPU time of the state of a component [s]."""
    component = stack.components[name]
    if not component.remembers:
        return 0.0
    begun = time.process_time()
    for _ in range(_SNAPSHOTS):
        pack_snapshot(component.snapshot())
    return (time.process_time() - begun) / _SNAPSHOTS


def recorder_cost(namespace: str, deployment: Deployment, written: Written, path: Path) -> dict[str, Any]:
    """Hand batches to a recorder in a process of its own, as fast as a robot in real time would.

    Args:
        namespace: of a bus of its own, whose hub is this process.
        deployment: for the file's head.
        written: the batches.
        path: the file.

    Returns:
        `recorder`: share of a core that it takes; `handing_over`: that of the hub meanwhile; `mb_per_s`: what the
        file grows by for each second; `lost`: in words, batches that did not come.

    Raises:
        BusError: the recorder did not come up, or has ended.
    """
    context = multiprocessing.get_context("spawn")
    ready, results = context.Event(), context.Queue()
    session = Session(namespace, hub=True)
    child = context.Process(target=_record, args=(namespace, path, ready, results), daemon=True)
    try:
        serve_deployment(session, deployment)
        kept: dict[str, dict[int, bytes]] = {}
        for _, process, number, payload in written.batches:
            kept.setdefault(process, {})[number] = payload
        for process, payloads in kept.items():
            session.serve_each(f"{LOG}/{process}", payloads.get)
        child.start()
        if not ready.wait(_PATIENCE_S):
            raise BusError("bench: the recorder did not come up")
        cpu_s, begun = time.process_time(), time.monotonic()
        for due, process, _, payload in written.batches:
            time.sleep(max(begun + due - time.monotonic(), 0.0))
            session.put(f"{LOG}/{process}", payload, lossless=False)
        cpu_s = time.process_time() - cpu_s
        recorder_s, lost = results.get(timeout=_PATIENCE_S)
        child.join(_PATIENCE_S)
    except queue.Empty:
        raise BusError("bench: the recorder has ended before the recording") from None
    finally:
        if child.pid is not None:
            child.kill()
            child.join()
        session.close()
    return {
        "recorder": recorder_s / written.seconds,
        "handing_over": cpu_s / written.seconds,
        "mb_per_s": path.stat().st_size / 1e6 / written.seconds,
        "lost": lost,
    }


def _record(namespace: str, path: Path, ready: Event, results: multiprocessing.Queue) -> None:
    """The recorder's process."""
    session = Session(namespace)
    recorder = Recorder(session, path)
    ready.set()
    recorder.run(lambda: False)
    results.put((recorder.cpu_s, recorder.lost))
    session.close()
