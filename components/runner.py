"""One process: a component, its inbox and outbox on the bus, released by simulated or by monotonic time."""

from __future__ import annotations

import gc
import os
import queue
import signal
import time
from threading import Event

from surefoot.bus.codec import check, encode
from surefoot.bus.message import Message
from surefoot.bus.session import Session
from surefoot.bus.topics import PROCESSES, Process
from surefoot.components import clock_messages as clock
from surefoot.components.component import Component, Inbox, Life, Outbox
from surefoot.components.health import Health
from surefoot.components.registry import component_class
from surefoot.components.scheduler import NS
from surefoot.components.topic_buffer import TopicBuffers
from surefoot.config.deployment import Deployment

_INPUT_TIMEOUT_S = 10.0
_ORPHAN_LOOK_S = 0.2


class Runner:
    """Runs one component in this process until it is told to stop or its parent is gone."""

    hub = False

    def __init__(self, deployment: Deployment, name: str):
        self._deployment, self._name = deployment, name
        self._process: Process = PROCESSES[name]
        self._session = Session(deployment.run.namespace, hub=self.hub)
        self.component: Component = component_class(name)(deployment)
        self.inbox = Inbox(self.component.inputs)
        self._buffers = TopicBuffers(self.component.inputs)
        self._outgoing: list[tuple[str, Message]] = []
        self._outbox = Outbox(self.component.outputs, lambda key, message: self._outgoing.append((key, message)))
        self._health = Health(self.component, self._session)
        self._active = False
        self._stop = Event()
        self._parent = os.getppid()
        for number in (signal.SIGTERM, signal.SIGINT):
            signal.signal(number, lambda *_: self._stop.set())

    def run(self) -> int:
        """Until the end; returns the exit code."""
        for key in self.component.inputs:
            self._session.subscribe(key, self._buffers.put)
        self.component.warm_up()
        gc.collect()
        gc.freeze()
        self._health.life = Life.IDLE
        try:
            if self._deployment.run.clock == "simulated":
                self._follow_simulated_time()
            elif self._process.rate_hz:
                self._follow_timer()
            else:
                self._follow_trigger()
        except Exception as error:
            self._health.life, self._health.reason = Life.FAILED, f"{type(error).__name__}: {error}"
            self._health.tell(0.0, self.inbox, self._buffers.bad, now=True)
            raise
        finally:
            self._session.close()
        return 0

    def _follow_simulated_time(self) -> None:
        """Step at each release of the clock's master; the outputs, then the done token, answer it."""
        releases: queue.Queue[bytes] = queue.Queue()
        self._session.subscribe(f"{clock.RELEASE}/{self._name}", lambda key, payload: releases.put(payload))
        self._session.put(f"{clock.HELLO}/{self._name}", b"")
        t = 0.0
        last = None
        while not self._stop.is_set():
            self._health.tell(t, self.inbox, self._buffers.bad)
            try:
                t_ns, visible, before = clock.unpack_release(releases.get(timeout=_ORPHAN_LOOK_S))
            except queue.Empty:
                if os.getppid() != self._parent:
                    return
                if last is None:
                    # The hub may have come up after the first greeting.
                    self._session.put(f"{clock.HELLO}/{self._name}", b"")
                continue
            if t_ns == clock.STOP_NS:
                return
            if last is None:
                self._outbox.continue_from(visible)
                self._buffers.start_after(before)
            if last == t_ns:
                continue
            last, t = t_ns, t_ns / NS
            self._health.reason = self._buffers.deliver_visible(visible, self.inbox, _INPUT_TIMEOUT_S)
            step_ms = self._step(t)
            counts: dict[str, int] = {}
            for key, message in self._outgoing:
                self._session.put(key, encode(message))
                counts[key] = counts.get(key, 0) + 1
            self._outgoing.clear()
            self._session.put(f"{clock.DONE}/{self._name}", clock.pack_done(t_ns, counts, step_ms))

    def _follow_timer(self) -> None:
        """Absolute deadlines on the monotonic clock; after an overrun the missed ones are skipped and counted."""
        period = 1.0 / self._process.rate_hz
        deadline = time.monotonic()
        while not self._stop.is_set() and os.getppid() == self._parent:
            deadline += period
            wait = deadline - time.monotonic()
            if wait > 0.0:
                time.sleep(wait)
            else:
                missed = int(-wait / period) + 1
                self._health.overruns += missed
                deadline += missed * period
            self._live_step()

    def _follow_trigger(self) -> None:
        """Step on every n-th message of the trigger."""
        arrived, seen = self._buffers.arrived, 0
        while not self._stop.is_set() and os.getppid() == self._parent:
            with arrived:
                arrived.wait(_ORPHAN_LOOK_S)
            self._buffers.deliver_all(self.inbox)
            fresh = len(self.inbox.new(self._process.trigger))
            seen += fresh
            if fresh and seen >= self._process.every:
                seen = 0
                self._live_step(delivered=True)
            self._health.tell(self._live_t(), self.inbox, self._buffers.bad)

    def _live_step(self, delivered: bool = False) -> None:
        if not delivered:
            self._buffers.deliver_all(self.inbox)
        t = self._live_t()
        self._step(t)
        for key, message in self._outgoing:
            self._session.put(key, encode(message))
        self._outgoing.clear()
        self._health.tell(t, self.inbox, self._buffers.bad)

    def _live_t(self) -> float:
        return time.monotonic() - self._deployment.run.epoch_s

    def _step(self, t: float) -> float:
        """Activate or step; returns the wall time [ms]."""
        begun = time.perf_counter()
        component, health = self.component, self._health
        if not self._active:
            self._active = component.activate(t, self.inbox)
            health.life = Life.RUN if self._active else Life.ACTIVATING
            health.reason = "" if self._active else component.waiting_for(t, self.inbox)
        if self._active:
            component.step(t, self.inbox, self._outbox)
            for _, message in self._outgoing:
                check(message)
        self.inbox.clear_new()
        step_ms = 1e3 * (time.perf_counter() - begun)
        health.stepped(step_ms)
        return step_ms


class HubRunner(Runner):
    """The runner of io on the monotonic clock: it hosts the bus."""

    hub = True
