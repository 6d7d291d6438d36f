"""The process of io with simulated time: it hosts the bus, drives the scheduler and waits for the others."""

from __future__ import annotations

import gc
import queue
import time
from collections import deque
from functools import partial
from math import ceil
from threading import Event, Lock

from surefoot.bus.errors import MessageError
from surefoot.bus.session import Marked, Session
from surefoot.bus.topics import PROCESSES, TOPICS, processes
from surefoot.components import clock_messages as clock
from surefoot.components.component import Life
from surefoot.components.deployment_desk import serve_deployment
from surefoot.components.input_sequence import KEPT
from surefoot.components.operator_desk import OperatorDesk
from surefoot.components.process_end import ProcessEnd
from surefoot.components.registry import component_class
from surefoot.components.scheduler import NS, Executor, Scheduler
from surefoot.components.stepper import Stepper
from surefoot.config.deployment import Deployment

_LOOK_S = 0.2
_WORTH_SAYING_S = 0.5
_GONE_S = 2.0  # a process that has not answered for so long may be replaced by one that was started by hand
_FOR_EVER_NS = 10**18


class MasterStopped(Exception):
    """The run is to end while a step is awaited."""


class ClockMaster:
    """Steps io here and every other process over the bus, in the scheduler's order.

    Simulated time does not pass a release + budget until that process has answered: a slow or restarted
    process slows time and changes nothing else. The last messages of every topic are kept here, for readers that
    come late or again: their writer may be gone.

    Attributes:
        session: the bus.
        writers: marks of the sessions that are, or have been, each process.
        refuse: counts and tells a message that is not what its key promises.
    """

    def __init__(self, deployment: Deployment, boot: int = 0, parent: int = 0):
        self._end = ProcessEnd(parent)
        self.session = Session(deployment.run.namespace, hub=True, network=deployment.network)
        serve_deployment(self.session, deployment)
        table = processes(deployment.mpc.profile)
        self._stepper = Stepper(component_class("io")(deployment), self.session, table["io"], boot)
        self.refuse = self._stepper.buffers.drop
        self._desk = OperatorDesk(self.session, self.refuse, self._stepper.buffers.incidents.note, deployment)
        self.writers: dict[str, list[bytes]] = {}
        self._remote = {name: RemoteExecutor(name, self) for name in PROCESSES if name != "io"}
        executors: dict[str, Executor] = {"io": _HostedExecutor(self._stepper, self), **self._remote}
        self.scheduler = Scheduler(executors, table)
        # A process that is released again reads what was visible then: time has gone on by its budget at the most.
        budget_s = max(process.budget_s for process in table.values())
        self._kept: dict[str, deque[bytes]] = {
            key: deque(maxlen=KEPT + ceil(topic.rate_hz * budget_s))
            for key, topic in TOPICS.items()
            if topic.writer in PROCESSES
        }

    def run(self) -> int:
        """Until told to stop or the parent is gone; returns the exit code."""
        self._stepper.connect()
        self._stepper.look = self.look
        for key, kept in self._kept.items():
            self.session.serve(f"{clock.KEPT}/{key}", partial(list, kept))
        gc.collect()
        gc.freeze()
        self._stepper.health.life = Life.IDLE
        try:
            for executor in self._remote.values():
                executor.wait_ready()
            self.waiting("")
            self._between()  # a command given before the start is there at t = 0
            self.scheduler.run_until(_FOR_EVER_NS, self._between)
        except MasterStopped:
            pass
        except Exception as error:
            self._stepper.fail(error)
            raise
        finally:
            for name in self._remote:
                self.session.put(f"{clock.RELEASE}/{name}", clock.pack_release(clock.Release(clock.STOP_NS, {})))
            self._stepper.deactivate(self.scheduler.t_ns / NS)  # time has ended: one release is all there is
            self._desk.close()
            self._stepper.close()
            self.session.close()
        return 0

    def look(self) -> None:
        """Called while waiting.

        Raises:
            MasterStopped: there is no reason to wait on.
        """
        if self._end.due:
            raise MasterStopped
        self._stepper.tell(self.scheduler.t_ns / NS)

    def keep(self, sent: dict[str, list[bytes]]) -> dict[str, int]:
        """Keep what a step has published; how many messages that are on each topic."""
        for key, payloads in sent.items():
            self._kept[key].extend(payloads)
        return {key: len(payloads) for key, payloads in sent.items()}

    def note_writers(self) -> None:
        """A process has come up, or up again: from now on it is one of those who may publish."""
        here = {name: [self.session.mark] for name in ("io", "operator")}
        self.writers = here | {name: list(each.known) for name, each in self._remote.items()}
        self._stepper.buffers.trust(self.writers)

    def waiting(self, reason: str) -> None:
        """Say in words why time stands still."""
        self._stepper.health.reason = reason

    def _between(self) -> bool:
        """Between two instants: pass on commands, tell the status; true to end."""
        t = self.scheduler.t_ns / NS
        for key, count in self._desk.publish(t, self._stepper.take_said()).items():
            if count:
                self.scheduler.inject(key, count)
        self._stepper.tell(t)
        return self._end.due


class RemoteExecutor:
    """A component in another process, released and awaited over the bus.

    It keeps where that process stands after each step, and hands it to the one that takes its place.

    Attributes:
        known: marks of the sessions that have been that process.
    """

    def __init__(self, name: str, master: ClockMaster):
        self._name, self._master = name, master
        self._outputs = {key for key, topic in TOPICS.items() if topic.writer == name}
        self._pending: tuple[int, dict[str, int]] | None = None
        self._resume = clock.Resume({}, b"")
        self._new_there = False
        self._told: dict[str, list[bytes]] | None = None
        self._answered_ns = -1
        self._done: queue.SimpleQueue[tuple[clock.Done, dict[str, int]]] = queue.SimpleQueue()
        self.known: set[bytes] = set()
        self._boot = -1
        self._waits_since = float("inf")
        self._ready = Event()
        self._lock = Lock()
        master.session.subscribe(f"{clock.DONE}/{name}", lambda key, payload: self._on_done(payload))
        master.session.subscribe(f"{clock.HELLO}/{name}", lambda key, payload: self._on_hello(payload))

    def wait_ready(self) -> None:
        """Until the process has said hello."""
        while not self._ready.wait(_LOOK_S):
            self._master.waiting(f"waiting for {self._name} to come up")
            self._master.look()

    def release(self, t_ns: int, visible: dict[str, int]) -> None:
        with self._lock:
            self._pending = (t_ns, dict(visible))
            self._send(*self._pending)

    def collect(self) -> dict[str, int]:
        if self._pending is None:
            raise RuntimeError(f"{self._name} was collected before it was released")
        t_ns, visible = self._pending
        begun = self._waits_since = time.monotonic()
        said = False
        while True:
            try:
                done, counts = self._done.get(timeout=_LOOK_S)
            except queue.Empty:
                waited = time.monotonic() - begun
                if waited > _WORTH_SAYING_S:
                    said = True
                    self._master.waiting(f"simulated time waits for {self._name}, {waited:.1f} s now")
                self._master.look()
                continue
            if done.t_ns == t_ns:
                break
        with self._lock:
            self._resume = clock.Resume(visible, done.snapshot)
            self._pending = None
            self._waits_since = float("inf")
        if said:
            self._master.waiting("")
        return counts

    def _on_done(self, payload: Marked) -> None:
        """Kept at once: who comes up now asks for what has been sent already and is not visible yet."""
        try:
            done = clock.unpack_done(payload)
        except MessageError as error:
            self._master.refuse(str(error))
            return
        others, pending = ", ".join(sorted(done.sent.keys() - self._outputs)), self._pending
        if payload.writer not in self.known:
            self._master.refuse(f"{clock.DONE}: a second {self._name} answers for {done.t_ns / NS:.3f} s")
        elif others:
            self._master.refuse(f"{clock.DONE}: {others:.80}: no output of {self._name}")
        elif pending is not None and done.t_ns == pending[0] and done.t_ns != self._answered_ns:
            # What is said again, because a release was sent again, is passed over.
            self._answered_ns = done.t_ns
            self._done.put((done, self._master.keep(done.sent)))

    def _on_hello(self, payload: Marked) -> None:
        """The process is up, or up again, or has heard nothing for a while: what it owes is asked once more."""
        writer = payload.writer
        try:
            hello = clock.unpack_hello(payload)
        except MessageError as error:
            self._master.refuse(str(error))
            return
        gone = time.monotonic() - self._waits_since > _GONE_S
        if not (hello.boot > self._boot or writer in self.known or gone):
            self._master.refuse(f"{clock.HELLO}: a second {self._name}, while the first one answers")
            return
        with self._lock:
            self._boot, self._told = hello.boot, None
            self._new_there |= hello.new
            self.known.add(writer)
            self._master.note_writers()
            if self._pending is not None:
                self._send(*self._pending)
        self._ready.set()

    def _send(self, t_ns: int, visible: dict[str, int]) -> None:
        resume = self._resume if self._new_there else None
        writers = self._master.writers if self._told is not self._master.writers else None
        self._told = self._master.writers
        payload = clock.pack_release(clock.Release(t_ns, visible, resume, writers))
        self._new_there = False
        self._master.session.put(f"{clock.RELEASE}/{self._name}", payload)


class _HostedExecutor:
    """io itself, in the master's process, on the same terms as the others."""

    def __init__(self, stepper: Stepper, master: ClockMaster):
        self._stepper, self._master = stepper, master

    def release(self, t_ns: int, visible: dict[str, int]) -> None:
        self._stepper.read_visible(visible)
        self._stepper.step(t_ns / NS)

    def collect(self) -> dict[str, int]:
        return self._master.keep(self._stepper.publish())
