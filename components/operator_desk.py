"""Where people's commands reach the stack: dated, numbered and published, by the process that holds the bus."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable

from surefoot.bus.codec import encode
from surefoot.bus.messages import OperatorCommand
from surefoot.bus.recording.journal import Journal
from surefoot.bus.service_keys import LOG
from surefoot.bus.session import Session
from surefoot.components import clock_messages as clock
from surefoot.components.topic_buffer import KEPT

_TOPIC = "operator/command"
_NAME = "operator"
_LONGEST = 64  # characters of a command


class OperatorDesk:
    """Turns requests into messages on `operator/command`.

    What is no word is refused here; which words are commands is the state machine's business, which answers.
    """

    def __init__(self, session: Session, refuse: Callable[[str], None], lossless: bool = True):
        """For the process that holds the bus.

        Args:
            session: the bus.
            refuse: told, by key, of each request that is no word.
            lossless: wait for a reader that is late; in real time io waits for nobody.
        """
        self._session, self._refuse, self._lossless = session, refuse, lossless
        self._requests: deque[bytes] = deque(maxlen=KEPT)
        self._kept: deque[bytes] = deque(maxlen=KEPT)
        self._sent = 0
        self._journal = Journal(_NAME)
        session.subscribe(clock.REQUEST, lambda key, payload: self._requests.append(payload))
        session.serve(f"{clock.KEPT}/{_TOPIC}", lambda: list(self._kept))
        session.serve_each(f"{LOG}/{_NAME}", self._journal.kept)

    def publish(self, t: float) -> int:
        """Publish at time `t` [s] what has been asked; how many commands that were."""
        count = 0
        for _ in range(len(self._requests)):
            asked = self._requests.popleft()
            command = asked.decode(errors="replace")
            if len(command) > _LONGEST or not command.isprintable() or "\ufffd" in command:
                self._refuse(f"{clock.REQUEST}: {asked[:_LONGEST]!r:.80} is no command")
                continue
            payload = encode(OperatorCommand(t=t, seq=self._sent, valid=True, command=command))
            self._kept.append(payload)
            self._session.put(_TOPIC, payload, self._lossless)
            self._journal.note_message(t, _TOPIC, self._sent, payload)
            self._sent += 1
            count += 1
        if self._journal.batch_is_due():
            self._log()
        return count

    def close(self) -> None:
        """Hand over the end of the journal."""
        self._log(last=True)

    def _log(self, last: bool = False) -> None:
        if (batch := self._journal.take_packed(last)) is not None:
            self._session.put(f"{LOG}/{_NAME}", batch, lossless=False)
