"""What a process has read and published, noted where it happens: a recording at the source loses nothing."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import msgpack
import numpy as np

from surefoot.bus.codec import encode
from surefoot.bus.errors import MessageError
from surefoot.bus.message import Message
from surefoot.bus.recording.step_log import CHECKPOINT, STEPS, Checkpoint, StepLog
from surefoot.bus.service_keys import LOG

CHECKPOINT_S = 1.0
"""A replay can begin at every second of a run."""

_BATCH_S = 0.1  # of wall time: what a process that is killed takes with it at the most
_BATCH_BYTES = 1 << 20
_KEPT_S = 8.0  # a recorder that was held up can ask for what it has missed
_KEPT_BATCHES = 60  # and one that comes late for the beginning of a process that seldom has anything to tell

Record = tuple[str, int, int, bytes]
"""Key, time on the run's clock [ns], sequence number, bytes."""


@dataclass(frozen=True)
class Batch:
    """Some successive records of one process.

    Attributes:
        process: its name.
        boot: counts its restarts.
        number: of the batch since the process began, from 0.
        last: no more will follow.
        records: in the order in which they were noted.
    """

    process: str
    boot: int
    number: int
    last: bool
    records: list[Record]

    def pack(self) -> bytes:
        """Bytes for the bus."""
        return msgpack.packb([self.process, self.boot, self.number, self.last, self.records])

    @staticmethod
    def unpack(payload: bytes) -> Batch:
        """What `pack` packed.

        Raises:
            MessageError: it is not that.
        """
        try:
            process, boot, number, last, records = msgpack.unpackb(payload)
            return Batch(str(process), int(boot), int(number), bool(last), [tuple(each) for each in records])
        except Exception as error:
            raise MessageError(f"{LOG}: not a batch of records ({type(error).__name__}: {error})") from None


class Journal:
    """The records of one process until they are taken, as batches, for the recorder.

    A batch is made ten times a second of wall time, or when it grows large: one message on the bus instead of
    a thousand. The latest are kept for a recorder that comes late or has lost one.
    """

    def __init__(self, process: str, inputs: tuple[str, ...] = (), boot: int = 0):
        """For the process of that name, which reads `inputs`, after `boot` restarts."""
        self._process, self._inputs, self._boot = process, inputs, boot
        self._records: list[Record] = []
        self._bytes = 0
        self._number = 0
        self._begun = time.monotonic()
        self._kept: deque[tuple[float, int, bytes]] = deque()
        self._steps = self._logged = self._checkpoints = 0
        self._checkpoint_t = -CHECKPOINT_S
        self._released: list[float] = []
        self._reads: list[tuple[int, int, int, int]] = []

    # Notes ----------------------------------------------------------------------------------------------

    def note_step(self, t: float, new: Iterable[Iterable[Message]]) -> None:
        """A step at time `t` [s] on what was new of each input, in the order of `inputs`."""
        step = len(self._released)
        for index, messages in enumerate(new):
            for message in messages:
                self._reads.append((step, index, message.boot, message.seq))
        self._released.append(t)
        self._steps += 1

    def note_message(self, t: float, key: str, seq: int, payload: bytes) -> None:
        """A message published at time `t` [s]."""
        self._note(key, t, seq, payload)

    @property
    def begun(self) -> bool:
        """Whether a state has been noted from which a replay can begin."""
        return self._checkpoints > 0

    def checkpoint_is_due(self, t: float) -> bool:
        """Whether the state is to be noted after the step at time `t` [s]."""
        return t // CHECKPOINT_S > self._checkpoint_t // CHECKPOINT_S  # all processes at the same time

    def note_checkpoint(
        self,
        t: float,
        state: bytes,
        latest: Mapping[str, Message | None],
        sent: Mapping[str, int],
        boot: int,
        active: bool,
        fresh: bool = False,
    ) -> None:
        """All that the process carries on from here.

        Args:
            t: time of its last step [s].
            state: its packed snapshot.
            latest: the newest message of each input.
            sent: how many messages each output has had.
            boot: of the messages it publishes.
            active: it steps already.
            fresh: the component is as it was made.
        """
        self._log_steps()
        payloads = {key: encode(message) for key, message in latest.items() if message is not None}
        checkpoint = Checkpoint(
            t=t,
            seq=self._checkpoints,
            boot=self._boot,
            valid=True,
            process=self._process,
            step=self._steps,
            active=active,
            fresh=fresh,
            state=np.frombuffer(state, np.uint8),
            inputs=tuple(payloads),
            latest=np.frombuffer(b"".join(payloads.values()), np.uint8),
            latest_size=np.array([len(each) for each in payloads.values()], np.int64),
            outputs=tuple(sent),
            next_seq=np.array(list(sent.values()), np.int64),
            writes_boot=boot,
        )
        self._note(f"{CHECKPOINT}/{self._process}", t, self._checkpoints, encode(checkpoint))
        self._checkpoints += 1
        self._checkpoint_t = t

    # Batches --------------------------------------------------------------------------------------------

    def batch_is_due(self) -> bool:
        """Whether it is time to hand over what was noted."""
        return self._bytes > _BATCH_BYTES or time.monotonic() - self._begun >= _BATCH_S

    def take(self, last: bool = False) -> Batch | None:
        """What was noted since the last time; None if nothing was and it is not the `last`."""
        self._log_steps()
        self._begun = time.monotonic()
        if not self._records and not last:
            return None
        batch = Batch(self._process, self._boot, self._number, last, self._records)
        self._number += 1
        self._records, self._bytes = [], 0
        return batch

    def take_packed(self, last: bool = False) -> bytes | None:
        """The same as bytes, which are kept for a while."""
        batch = self.take(last)
        if batch is None:
            return None
        payload, now = batch.pack(), time.monotonic()
        self._kept.append((now, batch.number, payload))
        while len(self._kept) > _KEPT_BATCHES and now - self._kept[0][0] > _KEPT_S:
            self._kept.popleft()
        return payload

    def kept(self, number: int) -> bytes | None:
        """A batch of the last few seconds, or of the last few at all (also called from the bus's thread)."""
        return next((payload for _, each, payload in list(self._kept) if each == number), None)

    def _log_steps(self) -> None:
        """Note the steps since the last log."""
        if not self._released:
            return
        reads = np.array(self._reads, np.int64).reshape(-1, 4).T.copy()
        log = StepLog(
            t=self._released[-1],
            seq=self._logged,
            boot=self._boot,
            valid=True,
            process=self._process,
            first_step=self._steps - len(self._released),
            release_t=np.array(self._released),
            inputs=self._inputs,
            read_step=reads[0],
            read_input=reads[1],
            read_boot=reads[2],
            read_seq=reads[3],
        )
        self._note(f"{STEPS}/{self._process}", log.t, self._logged, encode(log))
        self._logged += 1
        self._released, self._reads = [], []

    def _note(self, key: str, t: float, seq: int, payload: bytes) -> None:
        self._records.append((key, round(t * 1e9), seq, payload))
        self._bytes += len(payload)
