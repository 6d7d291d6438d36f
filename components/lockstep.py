"""All components in one process on simulated time: for tests, evaluation and debugging."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from surefoot.bus.codec import check, encode
from surefoot.bus.message import Message
from surefoot.bus.messages import OperatorCommand, Tuning
from surefoot.bus.recording.journal import Journal
from surefoot.bus.topics import PROCESSES, processes
from surefoot.components.clock_messages import pack_snapshot
from surefoot.components.component import Component, Inbox, Outbox
from surefoot.components.registry import component_class
from surefoot.components.scheduler import NS, Scheduler
from surefoot.config.deployment import Deployment
from surefoot.config.tuning import Tunings

Listener = Callable[[str, Message], None]
"""Called with (topic, message) when a message becomes visible."""


class LocalExecutor:
    """Steps one component in this process; its output waits until the scheduler collects it.

    Attributes:
        component, inbox, active: what is stepped, what it reads, and whether it steps already.
        journal: what it reads and publishes is noted there, if one is given before the first step.
    """

    def __init__(self, component: Component, bus: LocalBus):
        self.component = component
        self.inbox = Inbox(component.inputs)
        self.active = False
        self.journal: Journal | None = None
        self._t = 0.0
        self._bus = bus
        self._pending: list[tuple[str, Message]] = []
        self._outbox = Outbox(component.outputs, lambda key, message: self._pending.append((key, check(message))))
        self._read = dict.fromkeys(component.inputs, 0)

    def release(self, t_ns: int, visible: dict[str, int]) -> None:
        if self.journal is not None and not self.journal.begun:
            self._note_checkpoint(self.journal, fresh=True)
        for key, count in self._read.items():
            self._read[key] = self._bus.deliver(key, count, self.inbox)
        t = t_ns / NS
        if not self.active:
            self.active = self.component.activate(t, self.inbox)
        if self.active:
            self.component.step(t, self.inbox, self._outbox)
        if self.journal is not None:
            self.journal.note_step(t, [self.inbox.new(key) for key in self.component.inputs])
        self._t = t
        self.inbox.clear_new()

    def collect(self) -> dict[str, int]:
        counts: dict[str, int] = {}
        for key, message in self._pending:
            self._bus.show(key, message)
            counts[key] = counts.get(key, 0) + 1
            if self.journal is not None:
                self.journal.note_message(self._t, key, message.seq, encode(message))
        self._pending.clear()
        if self.journal is not None and self.component.remembers and self.journal.checkpoint_is_due(self._t):
            self._note_checkpoint(self.journal)
        return counts

    def _note_checkpoint(self, journal: Journal, fresh: bool = False) -> None:
        state = b"" if fresh else pack_snapshot(self.component.snapshot())
        latest = {key: self.inbox.latest(key) for key in self.component.inputs}
        journal.note_checkpoint(self._t, state, latest, self._outbox.sent, self._outbox.boot, self.active, fresh)


class LocalBus:
    """The in-process bus: the visible messages of each topic, kept until every reader has them."""

    def __init__(self) -> None:
        self.listeners: list[Listener] = []
        self._recent: dict[str, list[Message]] = {}
        self._count: dict[str, int] = {}

    def show(self, key: str, message: Message) -> None:
        """Make a message visible to readers and listeners."""
        recent = self._recent.setdefault(key, [])
        recent.append(message)
        if len(recent) > 64:
            del recent[:32]
        self._count[key] = self._count.get(key, 0) + 1
        for listener in self.listeners:
            listener(key, message)

    def deliver(self, key: str, read: int, inbox: Inbox) -> int:
        """Give a reader that has had `read` messages those after it; returns how many it has had now."""
        count = self._count.get(key, 0)
        if count > read:
            for message in self._recent[key][-(count - read) :]:
                inbox.deliver(key, message)
        return count


class Lockstep:
    """A whole stack in one process.

    Attributes:
        components: the components by name.
        executors: their executors, with the wall time of every step [ms].
    """

    def __init__(self, deployment: Deployment, names: Iterable[str] = PROCESSES, given: Iterable[Component] = ()):
        """Build the named components; those in `given` stand in for the process of their name."""
        self.bus = LocalBus()
        parts = {part.name: part for part in given}
        self.components = {name: parts.get(name) or component_class(name)(deployment) for name in names}
        self.executors = {name: LocalExecutor(part, self.bus) for name, part in self.components.items()}
        self.scheduler = Scheduler(self.executors, processes(deployment.mpc.profile))
        self._commands = self._changes = 0
        self._tunings = Tunings(deployment)
        for component in self.components.values():
            component.warm_up()

    @property
    def t(self) -> float:
        """Simulated time [s]."""
        return self.scheduler.t_ns / NS

    def listen(self, listener: Listener) -> None:
        """Call `listener` with every message that becomes visible."""
        self.bus.listeners.append(listener)

    def command(self, command: str) -> None:
        """Give an operator's command now."""
        message = OperatorCommand(t=self.t, seq=self._commands, valid=True, command=command)
        self._commands += 1
        self.bus.show("operator/command", message)
        self.scheduler.inject("operator/command")

    def tune(self, assignment: str) -> None:
        """Change a setting now, `section.key=value`.

        Raises:
            ConfigError: it cannot be tuned, or not to this value.
        """
        changed = self._tunings.change(assignment)
        self.bus.show("operator/tuning", Tuning(t=self.t, seq=self._changes, valid=True, assignment=changed))
        self._changes += 1
        self.scheduler.inject("operator/tuning")

    def run(self, until_s: float, stop: Callable[[], bool] = lambda: False) -> None:
        """Advance to simulated time `until_s` or until `stop()` holds."""

        def between() -> bool:
            self._pass_on()
            return stop()

        self.scheduler.run_until(round(until_s * NS), between)

    def _pass_on(self) -> None:
        """What people ask for at the robot itself is a command as any other."""
        for component in self.components.values():
            for command in component.said:
                self.command(command)
            component.said.clear()
