"""Records a stack that runs in one process."""

from __future__ import annotations

from pathlib import Path

from surefoot.bus.codec import encode
from surefoot.bus.message import Message
from surefoot.bus.recording.journal import Journal
from surefoot.bus.recording.writer import RecordingWriter
from surefoot.bus.topics import TOPICS
from surefoot.components.lockstep import Lockstep
from surefoot.config.deployment import Deployment
from surefoot.config.typed_toml import to_table
from surefoot.tools.recording.about import about

_MESSAGES = 1000  # between two looks at the journals


class LockstepRecording:
    """A recording of a `Lockstep`, from before its first step on."""

    def __init__(self, stack: Lockstep, deployment: Deployment, path: Path):
        """Begin `path`; the stack has not stepped yet.

        Raises:
            OSError: the file cannot be written.
        """
        self._stack = stack
        self._writer = RecordingWriter(path, about(to_table(deployment), "lockstep"))
        self._operator = Journal("operator")
        self._journals = [self._operator]
        for name, executor in stack.executors.items():
            executor.journal = Journal(name, executor.component.inputs)
            self._journals.append(executor.journal)
        self._heard = 0
        stack.listen(self._listen)

    def close(self) -> None:
        """Write what is left."""
        self._drain(last=True)
        self._writer.close()

    def _listen(self, key: str, message: Message) -> None:
        if TOPICS[key].writer == "operator":
            self._operator.note_message(message.t, key, message.seq, encode(message))
        self._heard += 1
        if self._heard % _MESSAGES == 0:
            self._drain()

    def _drain(self, last: bool = False) -> None:
        for journal in self._journals:
            batch = journal.take(last)
            if batch is not None:
                self._writer.add(batch)
