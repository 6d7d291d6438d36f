"""One component on the bus: its inputs arrive, it steps, its outputs leave, its health is told."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from math import inf

from surefoot.bus.codec import check, decode, encode
from surefoot.bus.message import Message
from surefoot.bus.recording.journal import Journal
from surefoot.bus.service_keys import LOG
from surefoot.bus.session import Session
from surefoot.bus.topics import TOPICS, Process
from surefoot.components import clock_messages as clock
from surefoot.components.component import Component, Inbox, Life, Outbox
from surefoot.components.health import Health
from surefoot.components.memory import ForeignMemory
from surefoot.components.relief import Place
from surefoot.components.topic_buffer import TopicBuffers

_INPUT_TIMEOUT_S = 10.0
_LEAVE_S = 0.1
_ASK_AGAIN_S = 0.3


class Stepper:
    """What every process does with its component, whoever releases it.

    Attributes:
        component: the component.
        buffers: what has arrived of its inputs.
        outbox: numbers its messages.
        journal: what it reads and publishes, for a recorder.
        health: what is told of it.
        look: called while it waits for a message; raises when there is no reason to wait on.
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
        self.journal = Journal(component.name, component.inputs, boot)
        self.health = Health(component, session, self.buffers, process, self.journal, boot)
        self.look: Callable[[], None] = lambda: None
        self._session = session
        self._inbox = Inbox(component.inputs)
        self._outgoing: list[tuple[str, Message]] = []
        self._lossless = {key: simulated or not TOPICS[key].rate_hz for key in component.outputs}
        self._boot = boot
        self._active = self._restored = False
        self._t = 0.0

    def connect(self) -> None:
        """Begin to listen to the inputs."""
        if self._boot == 0:
            self._begin_journal()
        self.buffers.connect(self._session)
        self._session.serve_each(f"{LOG}/{self.component.name}", self.journal.kept)

    def hear_again(self, key: str) -> None:
        """Take the newest message of an input for new, if it was published before this process listened."""
        if key in self.component.inputs:
            for payload in self._session.ask(f"{clock.KEPT}/{key}")[-1:]:
                self.buffers.put(key, payload)

    def resume(self, resume: clock.Resume, visible: dict[str, int]) -> None:
        """Take the place of a process that is gone, where its last finished step left it."""
        kept = {key: self._await_kept(key) for key in self.component.inputs if visible.get(key)}
        self.buffers.resume(resume.had, visible, kept, self._inbox)
        self.outbox.continue_from(visible)
        if resume.snapshot:
            try:
                self.component.restore(clock.unpack_snapshot(resume.snapshot))
                self._active = self._restored = True
            except ForeignMemory as error:  # of code that has changed since
                self.health.note = f"began anew: {error}"

    def read_visible(self, visible: dict[str, int]) -> None:
        """Take exactly the messages that are visible in simulated time."""
        self._begin_journal()
        self.health.lost = self.buffers.deliver_visible(visible, self._inbox, _INPUT_TIMEOUT_S, self._kept)

    def read_all(self) -> None:
        """Take everything that has arrived."""
        self._begin_journal()
        self.buffers.deliver_all(self._inbox)

    def step(self, t: float) -> None:
        """Activate or step at time `t` [s] on what was read."""
        begun, self._t = time.perf_counter(), t
        component, health = self.component, self.health
        self.journal.note_step(t, [self._inbox.new(key) for key in component.inputs])  # also of one that fails
        if not self._active:
            self._active = component.activate(t, self._inbox)
            health.life = Life.RUN if self._active else Life.ACTIVATING
            health.reason = "" if self._active else component.waiting_for(t, self._inbox)
        if self._active:
            health.life = Life.RUN
            component.step(t, self._inbox, self.outbox)
        self._inbox.clear_new()
        health.stepped(1e3 * (time.perf_counter() - begun))

    def take_said(self) -> list[str]:
        """What a person has commanded at the robot itself since the last call."""
        said = self.component.said.copy()
        self.component.said.clear()
        return said

    def deactivate(self, t: float) -> bool:
        """One release of a stop at time `t` [s]; true when the component has let go."""
        failed = self.health.life is Life.FAILED
        done = self.component.deactivate(t, self._inbox, self.outbox)
        self._inbox.clear_new()
        self._t = t
        if not failed:
            self.health.life = Life.IDLE if done else Life.DEACTIVATING
        return done

    def publish(self) -> dict[str, list[bytes]]:
        """Send what the step published; the bytes of the messages on each topic."""
        sent: dict[str, list[bytes]] = {}
        for key, message in self._outgoing:
            payload = encode(message)
            self._session.put(key, payload, self._lossless[key])
            self.journal.note_message(self._t, key, message.seq, payload)
            sent.setdefault(key, []).append(payload)
        self._outgoing.clear()
        if self.component.remembers and self.journal.checkpoint_is_due(self._t):
            self._note_checkpoint()
        if self.journal.batch_is_due():
            self._log()
        return sent

    def snapshot(self) -> bytes:
        """What the component remembers after its last step; empty while it is not active."""
        return clock.pack_snapshot(self.component.snapshot()) if self._active else b""

    def place(self) -> Place:
        """Where this process stands after its last step."""
        latest = {key: self._inbox.latest(key) for key in self.component.inputs}
        return Place(
            t=self._t,
            boot=self.outbox.boot,
            sent=self.outbox.sent,
            had=self.buffers.had,
            latest={key: encode(message) for key, message in latest.items() if message is not None},
            snapshot=self.snapshot(),
        )

    def rehearse(self, place: Place) -> None:
        """See that this process can take over from a place; its component is as before.

        Raises:
            ForeignMemory: it cannot: what stands there is of other code.
        """
        blank = clock.pack_snapshot(self.component.snapshot())
        if place.snapshot:
            self.component.restore(clock.unpack_snapshot(place.snapshot))
        self.component.restore(clock.unpack_snapshot(blank))

    def take_over(self, place: Place, t: float) -> float:
        """Go on at time `t` [s] from a place that another process has left.

        As long as nobody finds its predecessor's messages stale, no reader can tell the two apart. With an older
        memory, or none, this process begins anew.

        Returns:
            How long it must keep silent first, for everybody to notice that its predecessor is gone [s].
        """
        for key, payload in place.latest.items():
            self._inbox.deliver(key, decode(TOPICS[key].message, payload))
        self._inbox.clear_new()
        self.buffers.take_over(place.had)
        age = t - place.t
        limit = min((TOPICS[key].stale_after_s or inf for key in self.component.outputs), default=inf)
        if place.snapshot and age <= limit:
            self.component.restore(clock.unpack_snapshot(place.snapshot))
            self.outbox.continue_from(place.sent, place.boot)
            self._active = self._restored = True
            self._t = place.t
            return 0.0
        if place.snapshot:
            self.health.note = f"began anew: its memory was {age:.3f} s old, limit {limit:g} s"
        return limit if limit < inf else 0.0

    def tell(self, t: float, now: bool = False) -> None:
        """Publish the health if it is time to, or `now`."""
        self.health.tell(t, self._inbox, now)

    def fail(self, error: Exception) -> None:
        """Say what ends this process."""
        self._outgoing.clear()  # half a step
        self.health.life, self.health.reason = Life.FAILED, f"{type(error).__name__}: {error}"
        self.tell(self.health.t, now=True)

    def close(self) -> None:
        """Hand over the end of the journal."""
        if self._log(last=True):
            time.sleep(_LEAVE_S)  # let it leave before the session closes

    def _begin_journal(self) -> None:
        """Note the state before anything is read."""
        if not self.journal.begun:
            self._note_checkpoint(fresh=not self._restored)

    def _note_checkpoint(self, fresh: bool = False) -> None:
        state = b"" if fresh else clock.pack_snapshot(self.component.snapshot())
        latest = {key: self._inbox.latest(key) for key in self.component.inputs}
        self.journal.note_checkpoint(
            self._t, state, latest, self.outbox.sent, self.outbox.boot, self._active, fresh
        )

    def _log(self, last: bool = False) -> bool:
        """Hand over what the journal holds; whether that was anything."""
        payload = self.journal.take_packed(last)
        if payload is not None:
            # Never held up by a recorder: it asks again for what it has missed.
            self._session.put(f"{LOG}/{self.component.name}", payload, lossless=False)
        return payload is not None

    def _kept(self, key: str) -> Sequence[bytes] | None:
        """The last messages of a topic, from who keeps them; None when nobody answers."""
        kept = self._session.ask(f"{clock.KEPT}/{key}") or None
        self.health.lost = (
            "" if kept else f"{key}: a message is missing, and io does not answer: is the link down?"
        )
        self.tell(self.health.t)
        self.look()
        return kept

    def _await_kept(self, key: str) -> Sequence[bytes]:
        """The same; waits until there is an answer."""
        while (kept := self._kept(key)) is None:
            time.sleep(_ASK_AGAIN_S)
        return kept

    def _send(self, key: str, message: Message) -> None:
        self._outgoing.append((key, check(message)))
