"""Where people's commands reach the stack: dated, numbered and published, by the process that holds the bus."""

from __future__ import annotations

import json
from collections import deque
from collections.abc import Callable, Sequence
from functools import partial

from surefoot.bus.codec import encode
from surefoot.bus.messages import OperatorCommand, Tuning
from surefoot.bus.recording.journal import Journal
from surefoot.bus.service_keys import BEAT, LOG, REFUSED, REQUEST, TUNE
from surefoot.bus.session import Session
from surefoot.components import clock_messages as clock
from surefoot.components.heartbeat import Heartbeat
from surefoot.components.input_sequence import KEPT
from surefoot.config.deployment import Deployment
from surefoot.config.tuning import Tunings
from surefoot.config.typed_toml import ConfigError

COMMAND, TUNING = "operator/command", "operator/tuning"
_NAME = "operator"
_LONGEST = {REQUEST: 64, TUNE: 200}  # characters
_ALONE = ("sit", "stop", "halt", "pause", "damp", "cut")
"""What may be asked of a robot whose operator's heartbeat is missing: nothing that makes it move on."""


def pack_refusal(request: str, why: str) -> bytes:
    """What is told of a request that was not passed on."""
    return json.dumps([request, why]).encode()


def unpack_refusal(payload: bytes) -> tuple[str, str]:
    """The request, and why it was not passed on."""
    request, why = json.loads(payload)
    return request, why


class OperatorDesk:
    """Turns requests, and the end of the operator's heartbeat, into messages on `operator/command`.

    What is no word is refused here; which words are commands is the state machine's business, which answers. A
    change of the settings is checked here, whole as the deployment is, and becomes a message on `operator/tuning`.
    """

    def __init__(
        self,
        session: Session,
        drop: Callable[[str], None],
        refuse: Callable[[str, str], None],
        deployment: Deployment,
        lossless: bool = True,
    ):
        """For the process that holds the bus.

        Args:
            session: the bus.
            drop: told of each request that is no word, which counts as a bad message.
            refuse: told of each that cannot be passed on now: its key, and in words why.
            deployment: of the run: its heartbeat, and what can be tuned.
            lossless: wait for a reader that is late; in real time io waits for nobody.
        """
        self._session, self._drop, self._refuse, self._lossless = session, drop, refuse, lossless
        self._requests: deque[tuple[str, bytes]] = deque(maxlen=KEPT)
        self._kept: dict[str, deque[bytes]] = {key: deque(maxlen=KEPT) for key in (COMMAND, TUNING)}
        self._sent = dict.fromkeys(self._kept, 0)
        self._heartbeat = Heartbeat(deployment.operator.heartbeat_s)
        self._tunings = Tunings(deployment)
        self._journal = Journal(_NAME)
        for key in (REQUEST, TUNE):
            session.subscribe(key, lambda key, payload: self._requests.append((key, payload)))
        session.subscribe(BEAT, lambda key, payload: self._heartbeat.beat())
        for key, kept in self._kept.items():
            session.serve(f"{clock.KEPT}/{key}", partial(list, kept))
        session.serve_each(f"{LOG}/{_NAME}", self._journal.kept)

    def publish(self, t: float, at_robot: Sequence[str] = ()) -> dict[str, int]:
        """Publish at time `t` [s] what has been asked; how many messages that are on each topic.

        Args:
            t: of the run.
            at_robot: what a person asks for at the robot itself.
        """
        before = self._sent.copy()
        for command in at_robot:
            self._pass_on(t, command)
        for _ in range(len(self._requests)):
            key, asked = self._requests.popleft()
            words = asked.decode(errors="replace")
            if len(words) > _LONGEST[key] or not words.isprintable() or "\ufffd" in words:
                self._drop(f"{key}: {asked[: _LONGEST[key]]!r:.80} is no command")
            elif words.partition(": ")[0] not in _ALONE and (missing := self._heartbeat.missing):
                self._turn_down(key, words, f"{words}: {missing}; start surefoot heartbeat, then command again")
            elif key == REQUEST:
                self._pass_on(t, words)
            else:
                self._tune(t, words)
        if lost := self._heartbeat.lost():
            self._pass_on(t, f"sit: {lost}")
        if self._journal.batch_is_due():
            self._log()
        return {key: count - before[key] for key, count in self._sent.items()}

    def close(self) -> None:
        """Hand over the end of the journal."""
        self._log(last=True)

    def _pass_on(self, t: float, command: str) -> None:
        self._put(COMMAND, OperatorCommand(t=t, seq=self._sent[COMMAND], valid=True, command=command))

    def _tune(self, t: float, assignment: str) -> None:
        try:
            changed = self._tunings.change(assignment)
        except ConfigError as error:
            self._turn_down(TUNE, assignment, str(error))
        else:
            self._put(TUNING, Tuning(t=t, seq=self._sent[TUNING], valid=True, assignment=changed))

    def _put(self, key: str, message: OperatorCommand | Tuning) -> None:
        payload = encode(message)
        self._kept[key].append(payload)
        self._session.put(key, payload, self._lossless)
        self._journal.note_message(message.t, key, message.seq, payload)
        self._sent[key] += 1

    def _turn_down(self, key: str, request: str, why: str) -> None:
        self._refuse(key, f"refused {key}: {why}")
        self._session.put(REFUSED, pack_refusal(request, why), self._lossless)

    def _log(self, last: bool = False) -> None:
        if (batch := self._journal.take_packed(last)) is not None:
            self._session.put(f"{LOG}/{_NAME}", batch, lossless=False)
