"""Where people's commands reach the stack: dated, numbered and published, by the process that holds the bus."""

from __future__ import annotations

import json
from collections import deque
from collections.abc import Callable, Iterator, Sequence

from surefoot.bus.codec import encode
from surefoot.bus.messages import OperatorCommand
from surefoot.bus.recording.journal import Journal
from surefoot.bus.service_keys import BEAT, LOG, REFUSED
from surefoot.bus.session import Session
from surefoot.components import clock_messages as clock
from surefoot.components.heartbeat import Heartbeat
from surefoot.components.topic_buffer import KEPT
from surefoot.config.operator import Operator

_TOPIC = "operator/command"
_NAME = "operator"
_LONGEST = 64  # characters of a command
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

    What is no word is refused here; which words are commands is the state machine's business, which answers.
    """

    def __init__(self, session: Session, refuse: Callable[[str], None], settings: Operator, lossless: bool = True):
        """For the process that holds the bus.

        Args:
            session: the bus.
            refuse: told, by key, of each request that is no word, or cannot be passed on now.
            settings: of the heartbeat.
            lossless: wait for a reader that is late; in real time io waits for nobody.
        """
        self._session, self._refuse, self._lossless = session, refuse, lossless
        self._requests: deque[bytes] = deque(maxlen=KEPT)
        self._kept: deque[bytes] = deque(maxlen=KEPT)
        self._heartbeat = Heartbeat(settings.heartbeat_s)
        self._sent = 0
        self._journal = Journal(_NAME)
        session.subscribe(clock.REQUEST, lambda key, payload: self._requests.append(payload))
        session.subscribe(BEAT, lambda key, payload: self._heartbeat.beat())
        session.serve(f"{clock.KEPT}/{_TOPIC}", lambda: list(self._kept))
        session.serve_each(f"{LOG}/{_NAME}", self._journal.kept)

    def publish(self, t: float, at_robot: Sequence[str] = ()) -> int:
        """Publish at time `t` [s] what has been asked; how many commands that were.

        Args:
            t: of the run.
            at_robot: what a person asks for at the robot itself.
        """
        commands = [*at_robot, *self._asked()]
        if lost := self._heartbeat.lost():
            commands.append(f"sit: {lost}")
        for command in commands:
            payload = encode(OperatorCommand(t=t, seq=self._sent, valid=True, command=command))
            self._kept.append(payload)
            self._session.put(_TOPIC, payload, self._lossless)
            self._journal.note_message(t, _TOPIC, self._sent, payload)
            self._sent += 1
        if self._journal.batch_is_due():
            self._log()
        return len(commands)

    def close(self) -> None:
        """Hand over the end of the journal."""
        self._log(last=True)

    def _asked(self) -> Iterator[str]:
        """The requests that are to be passed on."""
        for _ in range(len(self._requests)):
            asked = self._requests.popleft()
            command = asked.decode(errors="replace")
            if len(command) > _LONGEST or not command.isprintable() or "\ufffd" in command:
                self._refuse(f"{clock.REQUEST}: {asked[:_LONGEST]!r:.80} is no command")
            elif command.partition(": ")[0] not in _ALONE and (missing := self._heartbeat.missing):
                why = f"{command}: {missing}; start surefoot heartbeat, then command again"
                self._refuse(f"{clock.REQUEST}: {why}")
                self._session.put(REFUSED, pack_refusal(command, why), self._lossless)
            else:
                yield command

    def _log(self, last: bool = False) -> None:
        if (batch := self._journal.take_packed(last)) is not None:
            self._session.put(f"{LOG}/{_NAME}", batch, lossless=False)
