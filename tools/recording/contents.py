"""What is in a recording and what is missing, without keeping its messages in memory."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from surefoot.bus.codec import decode
from surefoot.bus.errors import MessageError
from surefoot.bus.message import Message
from surefoot.bus.recording.reader import Recording
from surefoot.bus.recording.step_log import CHECKPOINT, STEPS, Checkpoint, StepLog
from surefoot.bus.recording.writer import message_type


@dataclass
class TopicContents:
    """One topic of a recording.

    Attributes:
        messages: how many are there.
        missing: numbers that its writer has used and that are not there.
        first_t, last_t: run's time of the first and the last [s].
        bytes: of all, as they were on the bus.
    """

    messages: int = 0
    missing: int = 0
    first_t: float = 0.0
    last_t: float = 0.0
    bytes: int = 0
    _next: dict[int, int] = field(default_factory=dict)

    def note(self, message: Message, t: float, size: int) -> None:
        """Take in one message; the first after a restart may take up where the process before it stood."""
        if self.messages == 0:
            self.first_t = t
        self.messages += 1
        self.bytes += size
        self.last_t = max(self.last_t, t)
        expected = self._next.get(message.boot)
        if expected is not None and message.seq > expected:
            self.missing += message.seq - expected
        self._next[message.boot] = message.seq + 1


@dataclass
class ProcessContents:
    """One process of a recording: its steps, restarts and the states that a replay can begin from."""

    steps: int = 0
    missing_steps: int = 0
    restarts: int = 0
    checkpoints: int = 0
    last_t: float = 0.0
    _next: dict[int, int] = field(default_factory=dict)

    def note_steps(self, log: StepLog) -> None:
        """Take in a log of steps."""
        expected = self._next.get(log.boot, log.first_step)
        self.missing_steps += max(log.first_step - expected, 0)
        self._next[log.boot] = log.first_step + len(log.release_t)
        self.steps += len(log.release_t)
        self.restarts = max(self.restarts, log.boot)
        self.last_t = log.t


class Contents:
    """A summary of a recording.

    Attributes:
        recording: the file.
        topics, processes: what is there of each, by name.
        bad: messages that cannot be decoded, in words.
        gaps: in words, what is missing; empty if the recording is whole.
    """

    def __init__(self, path: Path):
        """Read the file once.

        Raises:
            RecordingError: it is no recording.
        """
        self.recording = Recording(path)
        self.topics: dict[str, TopicContents] = {}
        self.processes: dict[str, ProcessContents] = {}
        self.bad: list[str] = []
        for item in self.recording:
            try:
                if item.digest:
                    self._note_digest(item.key, item.t_ns / 1e9)
                else:
                    self._note(item.key, item.t_ns / 1e9, item.payload)
            except (MessageError, KeyError) as error:
                self.bad.append(f"{item.key} at {item.t_ns / 1e9:.3f} s: {error}")
        self.gaps = self._gaps()

    def _note(self, key: str, t: float, payload: bytes) -> None:
        message = decode(message_type(key), payload)
        if isinstance(message, StepLog):
            self._process(key).note_steps(message)
        elif isinstance(message, Checkpoint):
            self._process(key).checkpoints += 1
        else:
            self.topics.setdefault(key, TopicContents()).note(message, t, len(payload))

    def _note_digest(self, key: str, t: float) -> None:
        topic = self.topics.setdefault(key, TopicContents())
        topic.messages += 1
        topic.last_t = t

    def _process(self, key: str) -> ProcessContents:
        return self.processes.setdefault(
            key.removeprefix(f"{STEPS}/").removeprefix(f"{CHECKPOINT}/"), ProcessContents()
        )

    def _gaps(self) -> list[str]:
        gaps = [f"the file is incomplete: {self.recording.damage}"] if self.recording.damage else []
        gaps += [
            f"{entry['process']}: its journal after {entry['boot']} restarts has no end: it was killed, or the "
            "recording ended before it did"
            for entry in self.recording.journals
            if not entry["ended"]
        ]
        gaps += [
            f"{key}: {topic.missing} of {topic.messages + topic.missing} messages are missing"
            for key, topic in self.topics.items()
            if topic.missing
        ]
        gaps += [
            f"{name}: {process.missing_steps} steps are missing"
            for name, process in self.processes.items()
            if process.missing_steps
        ]
        return gaps + [f"cannot be decoded: {each}" for each in self.bad]
