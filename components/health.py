"""A process's own health, published twice a second of real time."""

from __future__ import annotations

import os
import time
from collections import deque

import numpy as np

from surefoot.bus.codec import encode
from surefoot.bus.messages import ProcessStatus
from surefoot.bus.recording.journal import Journal
from surefoot.bus.session import Session
from surefoot.bus.topics import Process, nominal_hz
from surefoot.components.component import Component, Inbox, Life
from surefoot.components.topic_buffer import TopicBuffers
from surefoot.config.shared_settings import settings_digest

_PERIOD_S = 0.5


class Health:
    """Counts steps and tells the bus.

    Attributes:
        life, reason: what the process is doing, and in words why nothing moves.
        lost: an input that did not arrive; empty when all did.
        note: in words what is to be known of the process's start; mostly empty.
        overruns: deadlines missed.
        t: run's time of the last status [s].
    """

    def __init__(
        self,
        component: Component,
        session: Session,
        buffers: TopicBuffers,
        process: Process,
        journal: Journal,
        boot: int = 0,
    ):
        self.life, self.reason, self.lost, self.note = Life.INIT, "", "", ""
        self.overruns = self.steps = 0
        self.t = 0.0
        self._component, self._session, self._buffers = component, session, buffers
        self._journal, self._boot = journal, boot
        self._nominal_hz = nominal_hz(process)
        self._settings = settings_digest(component.deployment)
        self._recent: deque[float] = deque(maxlen=2000)
        self._told, self._told_steps = time.monotonic(), 0
        self._seq = self._damaged = 0

    def stepped(self, step_ms: float) -> None:
        """Note one step's wall time."""
        self.steps += 1
        self._recent.append(step_ms)

    def tell(self, t: float, inbox: Inbox, now: bool = False) -> None:
        """Publish the status if half a second has passed, or `now`."""
        clock = time.monotonic()
        if not now and clock - self._told < _PERIOD_S:
            return
        passed = t - self.t
        rate = (self.steps - self._told_steps) / passed if passed > 0.0 else 0.0
        self._told, self.t, self._told_steps = clock, t, self.steps
        keys = self._component.inputs
        ages = [-1.0 if (message := inbox.latest(key)) is None else t - message.t for key in keys]
        recent = np.array(self._recent) if self._recent else np.zeros(1)
        status = ProcessStatus(
            t=t,
            valid=True,
            seq=self._seq,
            boot=self._boot,
            process=self._component.name,
            life=self.life.value,
            reason=self._words(t),
            pid=os.getpid(),
            settings=self._settings,
            steps=self.steps,
            rate_hz=rate,
            nominal_hz=self._nominal_hz,
            step_p50_ms=float(np.percentile(recent, 50)),
            step_p99_ms=float(np.percentile(recent, 99)),
            step_max_ms=float(recent.max()),
            overruns=self.overruns,
            bad_messages=self._buffers.bad,
            input=keys,
            input_age_s=np.array(ages),
        )
        self._seq += 1
        key, payload = f"status/{self._component.name}", encode(status)
        self._session.put(key, payload, lossless=False)
        self._journal.note_message(t, key, status.seq, payload)

    def _words(self, t: float) -> str:
        """All there is to say at time `t` [s], the gravest first."""
        incidents = self._buffers.incidents
        if (lost := self._session.damaged) > self._damaged:
            self._damaged = lost
            incidents.note("link", f"{lost} messages came damaged over a link that broke, and were dropped")
        component = self._component
        said = self.reason, component.trouble, component.untuned, self.lost, incidents.words(t), self.note
        return "; ".join(words for words in said if words)
