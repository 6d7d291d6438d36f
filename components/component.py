"""The contract of a component: a pure step from an inbox to an outbox, and the life around it.

`step` reads nothing but its release time and its inbox and publishes only through its outbox. No clock,
environment, file or global random state inside it: that is what makes a run repeatable and replayable.
"""

from __future__ import annotations

from collections.abc import Callable
from enum import Enum
from typing import Any, ClassVar

from surefoot.bus.message import Message
from surefoot.bus.messages import Tuning
from surefoot.bus.topics import TOPICS, topic
from surefoot.components.memory import Memory
from surefoot.config.deployment import Deployment
from surefoot.config.tuning import tuned
from surefoot.config.typed_toml import ConfigError


class Life(Enum):
    """Life cycle of a component."""

    INIT = "INIT"
    IDLE = "IDLE"
    ACTIVATING = "ACTIVATING"
    RUN = "RUN"
    DEACTIVATING = "DEACTIVATING"
    FAILED = "FAILED"


class Inbox:
    """What a step may read: the latest message of each input, and those that are new since the last step."""

    def __init__(self, keys: tuple[str, ...]):
        self._latest: dict[str, Message | None] = {topic(key).key: None for key in keys}
        self._new: dict[str, list[Message]] = {key: [] for key in keys}

    def latest(self, key: str) -> Any:
        """The newest message of a topic, or None before the first."""
        return self._latest[key]

    def new(self, key: str) -> list[Any]:
        """Messages that arrived since the last step, oldest first."""
        return self._new[key]

    def fresh(self, key: str, t: float) -> Any:
        """The newest message if it is valid and dated within the topic's `stale_after_s` of t, else None.

        A date that is further ahead is as wrong as one that is past: an MPC's policy is for a moment to come, but
        for no later one than that.
        """
        message = self._latest[key]
        if message is None or not message.valid:
            return None
        limit = TOPICS[key].stale_after_s
        return None if limit > 0.0 and abs(t - message.t) > limit else message

    def deliver(self, key: str, message: Message) -> None:
        """Put a message in (the runner's business)."""
        self._latest[key] = message
        self._new[key].append(message)

    def clear_new(self) -> None:
        """Forget what was new (the runner calls it after each step)."""
        for messages in self._new.values():
            messages.clear()


class Outbox:
    """Where a step publishes; numbers the messages and hands them to the runner."""

    def __init__(self, keys: tuple[str, ...], send: Callable[[str, Message], None], boot: int = 0):
        self._seq = {topic(key).key: 0 for key in keys}
        self._send = send
        self._boot = boot

    @property
    def boot(self) -> int:
        """Of the messages."""
        return self._boot

    @property
    def sent(self) -> dict[str, int]:
        """How many messages each topic has had."""
        return dict(self._seq)

    def continue_from(self, counts: dict[str, int], boot: int | None = None) -> None:
        """Number on from how many messages each topic has had: a restarted process has predecessors.

        With a predecessor's `boot` no reader can tell the two apart.
        """
        for key in self._seq:
            self._seq[key] = counts.get(key, 0)
        self._boot = self._boot if boot is None else boot

    def publish(self, key: str, message: Message) -> None:
        """Publish on one of the component's outputs.

        Raises:
            KeyError: the topic is not an output of this component.
            TypeError: the message is not of the topic's type.
        """
        if key not in self._seq:
            raise KeyError(f"{key!r} is not an output; outputs are {', '.join(self._seq)}")
        if type(message) is not TOPICS[key].message:
            raise TypeError(f"{key} carries {TOPICS[key].message.__name__}, got {type(message).__name__}")
        self._send(key, message.numbered(self._seq[key], self._boot))
        self._seq[key] += 1


class Component:
    """Base of every component. Class attributes say its name, inputs and outputs; `bus.topics` its timing.

    Attributes:
        memory: what it carries from one step to the next.
        remembers: that is all there is to it; a robot, or its simulator, cannot be put back.
        complete: streams of which it needs every message; of others the newest is enough on the monotonic clock.
        trouble: in words why the last step could not do its work; empty when it could. The process's status
            tells it.
        said: what a person has commanded at the robot itself; who passes it on empties it.
        untuned: in words why a change of the settings was not taken over; empty when all were.
    """

    name: ClassVar[str]
    inputs: ClassVar[tuple[str, ...]] = ()
    outputs: ClassVar[tuple[str, ...]] = ()

    memory: ClassVar[Memory] = Memory()
    remembers: ClassVar[bool] = True

    complete: tuple[str, ...] = ()
    trouble: str = ""
    untuned: str = ""

    def __init__(self, deployment: Deployment):
        self.deployment = deployment
        self.said: list[str] = []
        self._original = deployment
        self._heeded: Tuning | None = None
        self.set_up()

    def set_up(self) -> None:
        """Make the parts that hold settings; when it is created, and again when a person has changed some."""

    def heed_tuning(self, inbox: Inbox) -> None:
        """Between two steps, go on with the settings that a person has changed.

        Parts that hold settings are made anew and take over what the old ones remember. The newest message tells
        all that was changed: a component that was restarted, or is replayed from the middle, needs no other.
        """
        message = inbox.latest("operator/tuning")
        if message is None or message is self._heeded:
            return
        self._heeded = message
        try:
            deployment = tuned(self._original, message.assignment)
        except ConfigError as error:  # io runs with other code
            self.untuned = f"goes on as it was: {error}"
            return
        kept, self.untuned = self.snapshot(), ""
        self.deployment = deployment
        self.set_up()
        self.restore(kept)

    def warm_up(self) -> None:
        """Everything slow, once: load, factorise, solve one problem."""

    def activate(self, t: float, inbox: Inbox) -> bool:
        """True once the inputs are healthy; called at each release until then."""
        return True

    def waiting_for(self, t: float, inbox: Inbox) -> str:
        """In words what `activate` still waits for."""
        missing = [key for key in self.inputs if inbox.latest(key) is None]
        return f"no message yet on {', '.join(missing)}" if missing else ""

    def step(self, t: float, inbox: Inbox, outbox: Outbox) -> None:
        """One release at time `t` [s]."""
        raise NotImplementedError

    def deactivate(self, t: float, inbox: Inbox, outbox: Outbox) -> bool:
        """Called at the process's rate when it is to end, until it returns true: a controller ramps down.

        It must work after a failed step too. The runner waits for a second at the most.
        """
        return True

    def snapshot(self) -> dict[str, Any]:
        """Its memory as numbers, strings, bytes, lists and arrays by name, for a restart or a replay.

        With it, and with the same inputs, another object of the class publishes the same bytes from here on.
        Arrays are the component's own: to be packed or copied before its next step.
        """
        return self.memory.of(self)

    def restore(self, state: dict[str, Any]) -> None:
        """Take over what `snapshot` gave, after `warm_up`.

        Raises:
            ForeignMemory: it is not of this component, or of other code; nothing has been taken over.
        """
        self.memory.restore(self, state)
