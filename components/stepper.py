"""One component on the bus: its inputs arrive, it steps, its outputs leave, its health is told."""

from __future__ import annotations

import time
from collections.abc import Sequence

from surefoot.bus.codec import check, encode
from surefoot.bus.message import Message
from surefoot.bus.session import Session
from surefoot.bus.topics import TOPICS, Process
from surefoot.components import clock_messages as clock
from surefoot.components.component import Component, Inbox, Life, Outbox
from surefoot.components.health import Health
from surefoot.components.memory import ForeignMemory
from surefoot.components.topic_buffer import TopicBuffers

_INPUT_TIMEOUT_S = 10.0


class Stepper:
    """What every process does with its component, whoever releases it.

    Attributes:
        component: the component.
        buffers: what has arrived of its inputs.
        outbox: numbers its messages.
        health: what is told of it.
    """

    def __init__(
        self, component: Component, session: Session, process: Process, boot: int = 0, simulated: bool = True
    ):
        """For a component in this process.

        Args:
            component: the component.
            session: the bus.
            process: when it steps.
            boot: counts the restarts of the process.
            simulated: time waits for every message; on the monotonic clock a stream's newest is enough.
        """
        self.component = component
        trigger = None if simulated else process.trigger
        self.buffers = TopicBuffers(component.inputs, trigger, component.complete)
        self.outbox = Outbox(component.outputs, self._send, boot)
        self.health = Health(component, session, self.buffers, process, boot)
        self._session = session
        self._inbox = Inbox(component.inputs)
        self._outgoing: list[tuple[str, Message]] = []
        self._lossless = {key: simulated or not TOPICS[key].rate_hz for key in component.outputs}
        self._active = False

    def connect(self) -> None:
        """Begin to listen to the inputs."""
        self.buffers.connect(self._session)

    def resume(self, resume: clock.Resume, visible: dict[str, int]) -> None:
        """Take the place of a process that is gone, where its last finished step left it."""
        kept = {key: self._kept(key) for key in self.component.inputs if visible.get(key)}
        self.buffers.resume(resume.had, visible, kept, self._inbox)
        self.outbox.continue_from(visible)
        if resume.snapshot:
            try:
                self.component.restore(clock.unpack_snapshot(resume.snapshot))
                self._active = True
            except ForeignMemory as error:  # of code that has changed since
                self.health.note = f"began anew: {error}"

    def read_visible(self, visible: dict[str, int]) -> None:
        """Take exactly the messages that are visible in simulated time."""
        self.health.lost = self.buffers.deliver_visible(visible, self._inbox, _INPUT_TIMEOUT_S, self._kept)

    def read_all(self) -> None:
        """Take everything that has arrived."""
        self.buffers.deliver_all(self._inbox)

    def step(self, t: float) -> None:
        """Activate or step at time `t` [s] on what was read."""
        begun = time.perf_counter()
        component, health = self.component, self.health
        if not self._active:
            self._active = component.activate(t, self._inbox)
            health.life = Life.RUN if self._active else Life.ACTIVATING
            health.reason = "" if self._active else component.waiting_for(t, self._inbox)
        if self._active:
            health.life = Life.RUN
            component.step(t, self._inbox, self.outbox)
        self._inbox.clear_new()
        health.stepped(1e3 * (time.perf_counter() - begun))

    def deactivate(self, t: float) -> bool:
        """One release of a stop at time `t` [s]; true when the component has let go."""
        failed = self.health.life is Life.FAILED
        done = self.component.deactivate(t, self._inbox, self.outbox)
        self._inbox.clear_new()
        if not failed:
            self.health.life = Life.IDLE if done else Life.DEACTIVATING
        return done

    def publish(self) -> dict[str, list[bytes]]:
        """Send what the step published; the bytes of the messages on each topic."""
        sent: dict[str, list[bytes]] = {}
        for key, message in self._outgoing:
            payload = encode(message)
            self._session.put(key, payload, self._lossless[key])
            sent.setdefault(key, []).append(payload)
        self._outgoing.clear()
        return sent

    def snapshot(self) -> bytes:
        """What the component remembers after its last step; empty while it is not active."""
        return clock.pack_snapshot(self.component.snapshot()) if self._active else b""

    def tell(self, t: float, now: bool = False) -> None:
        """Publish the health if it is time to, or `now`."""
        self.health.tell(t, self._inbox, now)

    def fail(self, error: Exception) -> None:
        """Say what ends this process."""
        self._outgoing.clear()  # half a step
        self.health.life, self.health.reason = Life.FAILED, f"{type(error).__name__}: {error}"
        self.tell(self.health.t, now=True)

    def _kept(self, key: str) -> Sequence[bytes]:
        """The last messages of a topic, from who keeps them."""
        return self._session.ask(f"{clock.KEPT}/{key}")

    def _send(self, key: str, message: Message) -> None:
        self._outgoing.append((key, check(message)))
