"""The process of io with simulated time: it hosts the bus, drives the scheduler and waits for the others."""

from __future__ import annotations

import gc
import os
import queue
import signal
import time
from threading import Event, Lock

from surefoot.bus.codec import check, encode
from surefoot.bus.message import Message
from surefoot.bus.messages import OperatorCommand
from surefoot.bus.session import Session
from surefoot.bus.topics import PROCESSES
from surefoot.components import clock_messages as clock
from surefoot.components.component import Inbox, Life, Outbox
from surefoot.components.health import Health
from surefoot.components.registry import component_class
from surefoot.components.scheduler import NS, Scheduler
from surefoot.components.topic_buffer import TopicBuffers
from surefoot.config.deployment import Deployment

_LOOK_S = 0.2
_INPUT_TIMEOUT_S = 10.0


class MasterStopped(Exception):
    """The run is to end while a step is awaited."""


class ClockMaster:
    """Steps io here and every other process over the bus, in the scheduler's order.

    Simulated time does not pass a release + budget until that process has answered: a slow or restarted
    process slows time and changes nothing else.
    """

    def __init__(self, deployment: Deployment, until_s: float = float("inf")):
        self._until_s = until_s
        self.session = Session(deployment.run.namespace, hub=True)
        self._stop = Event()
        self._parent = os.getppid()
        self._commands: queue.Queue[str] = queue.Queue()
        self._sent = 0
        self.session.subscribe(
            clock.REQUEST, lambda key, payload: self._commands.put(payload.decode(errors="replace"))
        )
        component = component_class("io")(deployment)
        self._health = Health(component, self.session)
        remote = {name: RemoteExecutor(name, self) for name in PROCESSES if name != "io"}
        self._io = _HostedExecutor(component, self.session, self._health)
        self.scheduler = Scheduler({"io": self._io, **remote})
        self._remote = remote
        for number in (signal.SIGTERM, signal.SIGINT):
            signal.signal(number, lambda *_: self._stop.set())

    def run(self) -> int:
        """Until told to stop, the parent is gone, or `until_s` of simulated time."""
        gc.collect()
        gc.freeze()
        self._health.life = Life.RUN
        try:
            self._health.reason = "waiting for the other processes to come up"
            for executor in self._remote.values():
                executor.wait_ready()
            self._health.reason = ""
            self._between()  # a command given before the start is there at t = 0
            end = round(min(self._until_s, 1e9) * NS)
            self.scheduler.run_until(end, self._between)
        except MasterStopped:
            pass
        for name in self._remote:
            self.session.put(f"{clock.RELEASE}/{name}", clock.pack_release(clock.STOP_NS, {}, {}))
        time.sleep(0.1)
        self.session.close()
        return 0

    def look(self) -> None:
        """Called while waiting.

        Raises:
            MasterStopped: there is no reason to wait on.
        """
        if self._stop.is_set() or os.getppid() != self._parent:
            raise MasterStopped
        self._health.tell(self.scheduler.t_ns / NS, self._io.inbox, self._io.bad)

    def waiting(self, reason: str) -> None:
        """Say in words why time stands still."""
        self._health.reason = reason

    def _between(self) -> bool:
        """Between two instants: pass on commands, tell the status; true to end."""
        while not self._commands.empty():
            self._command(self._commands.get())
        self._health.tell(self.scheduler.t_ns / NS, self._io.inbox, self._io.bad)
        return self._stop.is_set() or os.getppid() != self._parent

    def _command(self, command: str) -> None:
        message = OperatorCommand(t=self.scheduler.t_ns / NS, seq=self._sent, valid=True, command=command)
        self._sent += 1
        self.session.put("operator/command", encode(message))
        self.scheduler.inject("operator/command")


class RemoteExecutor:
    """A component in another process, released and awaited over the bus."""

    def __init__(self, name: str, master: ClockMaster):
        self._name, self._master = name, master
        self._pending: tuple[int, dict[str, int]] | None = None
        self._before: dict[str, int] = {}
        self._done: queue.Queue[bytes] = queue.Queue()
        self._ready = Event()
        self._lock = Lock()
        master.session.subscribe(f"{clock.DONE}/{name}", lambda key, payload: self._done.put(payload))
        master.session.subscribe(f"{clock.HELLO}/{name}", lambda key, payload: self._on_hello())

    def wait_ready(self) -> None:
        """Until the process has said hello."""
        while not self._ready.wait(_LOOK_S):
            self._master.waiting(f"waiting for {self._name} to come up")
            self._master.look()

    def release(self, t_ns: int, visible: dict[str, int]) -> None:
        with self._lock:
            self._pending = (t_ns, dict(visible))
            before = self._before
        payload = clock.pack_release(t_ns, visible, before)
        self._master.session.put(f"{clock.RELEASE}/{self._name}", payload)

    def collect(self) -> dict[str, int]:
        begun = time.monotonic()
        late = False
        while True:
            try:
                t_ns, counts, _ = clock.unpack_done(self._done.get(timeout=_LOOK_S))
            except queue.Empty:
                late = True
                waited = time.monotonic() - begun
                self._master.waiting(f"simulated time waits for {self._name}, {waited:.1f} s now")
                self._master.look()
                continue
            if self._pending is not None and t_ns == self._pending[0]:
                with self._lock:
                    self._pending = None
                if late:
                    self._master.waiting("")
                return counts

    def _on_hello(self) -> None:
        """The process is up, or up again: what it has not answered is asked once more."""
        self._ready.set()
        with self._lock:
            pending = self._pending
            self._before = before = dict(self._master.scheduler.visible) if pending is None else pending[1]
        if pending is not None:
            payload = clock.pack_release(pending[0], pending[1], before)
            self._master.session.put(f"{clock.RELEASE}/{self._name}", payload)


class _HostedExecutor:
    """io itself, in the master's process, on the same terms as the others."""

    def __init__(self, component, session: Session, health: Health):
        self._component, self._session, self._health = component, session, health
        self.inbox = Inbox(component.inputs)
        self._buffers = TopicBuffers(component.inputs)
        self._outgoing: list[tuple[str, Message]] = []
        self._outbox = Outbox(component.outputs, lambda key, message: self._outgoing.append((key, check(message))))
        for key in component.inputs:
            session.subscribe(key, self._buffers.put)

    @property
    def bad(self) -> int:
        """Malformed messages so far."""
        return self._buffers.bad

    def release(self, t_ns: int, visible: dict[str, int]) -> None:
        begun = time.perf_counter()
        self._buffers.deliver_visible(visible, self.inbox, _INPUT_TIMEOUT_S)
        self._component.step(t_ns / NS, self.inbox, self._outbox)
        self.inbox.clear_new()
        self._health.stepped(1e3 * (time.perf_counter() - begun))

    def collect(self) -> dict[str, int]:
        counts: dict[str, int] = {}
        for key, message in self._outgoing:
            self._session.put(key, encode(message))
            counts[key] = counts.get(key, 0) + 1
        self._outgoing.clear()
        return counts
