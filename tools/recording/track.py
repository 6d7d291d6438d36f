"""One process of a recording: its steps with what each of them read, and the states to begin from."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass, field
from typing import NamedTuple

from surefoot.bus.codec import decode
from surefoot.bus.recording.reader import Recorded, Recording
from surefoot.bus.recording.step_log import CHECKPOINT, STEPS, Checkpoint, StepLog
from surefoot.bus.recording.writer import message_type
from surefoot.components.registry import component_class


class MessageId(NamedTuple):
    """Which message: its topic, its writer's restarts, its number."""

    key: str
    boot: int
    seq: int


@dataclass(frozen=True)
class LoggedStep:
    """One step of a recording.

    Attributes:
        process, boot, index: which process, its restarts, and which of its steps since then.
        t: release time [s].
        reads: the messages that were new to it, in the order in which its inbox got them.
    """

    process: str
    boot: int
    index: int
    t: float
    reads: tuple[MessageId, ...]


@dataclass
class Track:
    """What a replay of one process needs besides the messages."""

    process: str
    steps: list[LoggedStep] = field(default_factory=list)
    checkpoints: list[Checkpoint] = field(default_factory=list)

    def checkpoint(self, boot: int, index: int) -> Checkpoint | None:
        """A state that was noted just before a step."""
        return next((each for each in self.checkpoints if each.boot == boot and each.step == index), None)

    def from_time(self, t: float) -> Track:
        """The same from the last state at or before `t` [s] on; the whole if there is none."""
        before = [each for each in self.checkpoints if each.t <= t]
        if not before:
            return self
        begin = before[-1].boot, before[-1].step
        return Track(
            self.process,
            [step for step in self.steps if (step.boot, step.index) >= begin],
            [each for each in self.checkpoints if (each.boot, each.step) >= begin],
        )


@dataclass
class Material:
    """What a replay of some processes needs of a recording.

    Attributes:
        tracks: by process.
        messages: what they read and published, in the order of the file.
    """

    tracks: dict[str, Track]
    messages: dict[MessageId, Recorded]


def load(recording: Recording, processes: Collection[str], until_t: float = float("inf")) -> Material:
    """Read what a replay of `processes` up to `until_t` [s] needs."""
    wanted = {key for name in processes for key in (*component_class(name).inputs, *component_class(name).outputs)}
    tracks = {name: Track(name) for name in processes}
    messages: dict[MessageId, Recorded] = {}
    for item in recording:
        prefix, _, name = item.key.partition("/")
        if prefix == STEPS and name in tracks:
            steps = _steps(decode(StepLog, item.payload))
            tracks[name].steps += [step for step in steps if step.t <= until_t]
        elif item.t_ns / 1e9 > until_t:
            continue
        elif prefix == CHECKPOINT and name in tracks:
            tracks[name].checkpoints.append(decode(Checkpoint, item.payload))
        elif item.key in wanted:
            if item.digest:  # only recordings of one undisturbed start have them
                messages[MessageId(item.key, 0, item.seq)] = item
            else:
                message = decode(message_type(item.key), item.payload)
                messages[MessageId(item.key, message.boot, message.seq)] = item
    return Material(tracks, messages)


def _steps(log: StepLog) -> Iterator[LoggedStep]:
    reads: list[list[MessageId]] = [[] for _ in log.release_t]
    columns = (log.read_step, log.read_input, log.read_boot, log.read_seq)
    for step, index, boot, seq in zip(*(column.tolist() for column in columns), strict=True):
        reads[step].append(MessageId(log.inputs[index], boot, seq))
    for number, t in enumerate(log.release_t.tolist()):
        yield LoggedStep(log.process, log.boot, log.first_step + number, t, tuple(reads[number]))
