"""Runs components again on exactly what each of their steps has read, and compares what they publish."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from surefoot.bus.codec import check, decode
from surefoot.bus.errors import RecordingError
from surefoot.bus.message import Message
from surefoot.bus.recording.reader import Recorded, Recording
from surefoot.bus.recording.step_log import Checkpoint
from surefoot.bus.recording.writer import message_type
from surefoot.bus.topics import PROCESSES, TOPICS
from surefoot.components.clock_messages import unpack_snapshot
from surefoot.components.component import Component, Inbox, Outbox
from surefoot.components.registry import component_class
from surefoot.config.deployment import Deployment
from surefoot.config.typed_toml import build, with_override, without_unknown
from surefoot.tools.recording.comparison import Comparison
from surefoot.tools.recording.numerics import numerics
from surefoot.tools.recording.track import LoggedStep, Material, MessageId, Track, load

TOLERANCE = 1e-4
"""Between machines of different arithmetic: of the largest number in a field."""


@dataclass
class ReplayResult:
    """How a replay went.

    Attributes:
        comparison: what was published, topic by topic.
        exact: the recording is of a machine of the same arithmetic: equal means equal bytes.
        steps: how many steps of each process were made again.
        left_out: steps of each that could not be: the recording lacks their inputs or a state to begin from.
        notes: what a reader should know, in words.
    """

    comparison: Comparison
    exact: bool = True
    steps: dict[str, int] = field(default_factory=dict)
    left_out: dict[str, int] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)


def recorded_deployment(recording: Recording, overrides: Sequence[str] = ()) -> tuple[Deployment, list[str]]:
    """The configuration that a recording was made with, and what of it this version does not know.

    Args:
        recording: the recording.
        overrides: assignments `section.key=value`, to see what they would have changed.

    Raises:
        ConfigError: this version cannot be configured so.
    """
    table, unknown = without_unknown(Deployment, recording.config)
    for assignment in overrides:
        table = with_override(table, assignment)
    return build(Deployment, table), unknown


def replay(
    path: Path,
    processes: Sequence[str],
    from_t: float = float("-inf"),
    until_t: float = float("inf"),
    overrides: Sequence[str] = (),
) -> ReplayResult:
    """Replay some processes of a recording.

    What one of them reads of another of them is what that one publishes now: several chain.

    Args:
        path: of the recording.
        processes: by name.
        from_t: begin at each one's last recorded state before this time [s].
        until_t: end with the steps at this time [s].
        overrides: settings other than the recorded ones.

    Raises:
        RecordingError: it is no recording, or holds nothing of any of the processes.
        ConfigError: this version does not take its configuration.
    """
    recording = Recording(path)
    deployment, unknown = recorded_deployment(recording, overrides)
    material = load(recording, processes, until_t)
    alike = recording.about.get("numerics") == numerics()
    result = ReplayResult(Comparison(material.messages, 0.0 if alike else TOLERANCE), alike)
    if not alike:
        result.notes.append(
            "recorded on a machine whose arithmetic gives other last bits: numbers are compared to "
            f"{TOLERANCE:g} of the largest in their field"
        )
    if recording.damage:
        result.notes.append(f"{path}: {recording.damage}")
    result.notes += [f"{key}: unknown to this version, left out" for key in unknown]
    held = [name for name in processes if material.tracks[name].steps or material.tracks[name].checkpoints]
    if not held:
        raise RecordingError(f"{path} holds nothing of {', '.join(processes)}")
    result.notes += [f"{name}: nothing of it was recorded" for name in processes if name not in held]
    ordered = [name for name in PROCESSES if name in held]
    players: dict[str, _Player] = {}
    for name in ordered:
        track = material.tracks[name]
        track = track.from_time(from_t)
        players[name] = _Player(deployment, track, material, players, result)
    steps = [step for player in players.values() for step in player.track.steps]
    order = {name: index for index, name in enumerate(PROCESSES)}
    for step in sorted(steps, key=lambda step: (step.t, order[step.process], step.boot, step.index)):
        players[step.process].play(step)
    for player in players.values():
        player.finish()
    return result


class _Player:
    """One process of a replay."""

    def __init__(
        self,
        deployment: Deployment,
        track: Track,
        material: Material,
        players: dict[str, _Player],
        result: ReplayResult,
    ):
        self.track = track
        self.published: dict[MessageId, Message] = {}
        self._deployment, self._material, self._players, self._result = deployment, material, players, result
        self._kind = component_class(track.process)
        self._component: Component | None = None
        self._active = False
        self._inbox = Inbox(self._kind.inputs)
        self._outbox = Outbox((), self._send)
        self._outgoing: list[tuple[str, Message]] = []
        self._begins: dict[int, dict[str, int]] = {}
        self._next = (-1, 0)
        result.steps[track.process] = result.left_out[track.process] = 0

    def play(self, step: LoggedStep) -> None:
        """Make one step again, if all that it needs is there."""
        component = self._component
        if component is None or (step.boot, step.index) != self._next:
            checkpoint = self.track.checkpoint(step.boot, step.index)
            if checkpoint is None:
                self._leave_out("there is no state to begin from")
                return
            component = self._begin(checkpoint)
        for each in step.reads:
            message = self._find(each)
            if message is None:
                self._leave_out(f"{each.key}: message {each.seq}, which it read at {step.t:.3f} s, is not there")
                return
            self._inbox.deliver(each.key, message)
        self._next = step.boot, step.index + 1
        if not self._active:
            self._active = component.activate(step.t, self._inbox)
        if self._active:
            component.step(step.t, self._inbox, self._outbox)
        self._inbox.clear_new()
        self._result.steps[step.process] += 1
        last = step == self.track.steps[-1]
        for key, message in self._outgoing:
            self.published[MessageId(key, message.boot, message.seq)] = message
            self._result.comparison.note(step.t, key, message, last)
        self._outgoing.clear()

    def begins(self, at: MessageId) -> bool:
        """Whether a message lies after the beginning of this replay."""
        return at.seq >= self._begins.get(at.boot, {}).get(at.key, 0 if at.boot in self._begins else 1 << 62)

    def finish(self) -> None:
        """Nothing more is played: what is still missing?"""
        for boot, begins in self._begins.items():
            last = max((step.t for step in self.track.steps), default=0.0)
            for key, first in begins.items():
                if not self._result.left_out[self.track.process]:
                    self._result.comparison.finish(key, boot, first, round(last * 1e9))

    def _begin(self, checkpoint: Checkpoint) -> Component:
        self._component = component = self._kind(self._deployment)
        component.warm_up()
        if not checkpoint.fresh:
            component.restore(unpack_snapshot(checkpoint.state.tobytes()) if checkpoint.state.size else {})
        self._active = checkpoint.active
        self._inbox = Inbox(self._kind.inputs)
        for key, payload in checkpoint.latest_payloads().items():
            if key in self._kind.inputs:
                self._inbox.deliver(key, decode(message_type(key), payload))
        self._inbox.clear_new()
        self._outbox = Outbox(self._kind.outputs, self._send, checkpoint.writes_boot)
        counts = dict(zip(checkpoint.outputs, checkpoint.next_seq.tolist(), strict=True))
        self._outbox.continue_from(counts)
        self._begins.setdefault(checkpoint.writes_boot, counts)
        return component

    def _find(self, at: MessageId) -> Message | None:
        """A message as the replay of its writer published it now, or as it was recorded."""
        writer = self._players.get(TOPICS[at.key].writer)
        if writer is not None and (message := writer.published.get(at)) is not None:
            return message
        there: Recorded | None = self._material.messages.get(at)
        if there is None or there.digest:
            return None
        if writer is not None and writer.begins(at) and not self._result.left_out[writer.track.process]:
            return None  # it should have been published now
        return decode(message_type(at.key), there.payload)

    def _send(self, key: str, message: Message) -> None:
        self._outgoing.append((key, check(message)))

    def _leave_out(self, why: str) -> None:
        process = self.track.process
        if not self._result.left_out[process]:
            self._result.notes.append(f"{process}: some steps are left out: {why}")
        self._result.left_out[process] += 1
        self._component, self._next = None, (-1, 0)
