"""A remote control over the bus: a method for every command, the answer that came back, a heartbeat behind it."""

from __future__ import annotations

import time
from collections import deque
from contextlib import suppress
from threading import Condition, Event, Lock, Thread

from surefoot.bus.codec import decode
from surefoot.bus.errors import MessageError
from surefoot.bus.messages import OperatorAnswer, OperatorCommand
from surefoot.bus.service_keys import BEAT, REFUSED, REQUEST
from surefoot.bus.session import Session
from surefoot.components.deployment_desk import ask_deployment
from surefoot.components.fsm.words import Answer, refused
from surefoot.components.operator_desk import unpack_refusal
from surefoot.config.operator import Operator
from surefoot.config.typed_toml import build

PATIENCE_S = 3.0
"""How long an answer is waited for; where simulated time is slow or stands, it comes late or never."""

_KEPT = 64


class Remote:
    """Commands the robot of a running stack.

    Every method says its command and waits for what becomes of it: an `Answer` that is taken or refused, in words.
    They may be called from any thread, one command at a time goes out. Closing it, or losing its process, ends the
    heartbeat; the session is the caller's.

    Attributes:
        heard: the answers to all commands, whoever gave them, newest last.
    """

    def __init__(self, session: Session, patience_s: float = PATIENCE_S, beats: bool = True):
        """Listen to answers, and begin to beat where the run asks for a heartbeat.

        Args:
            session: of the bus.
            patience_s: how long an answer is waited for [s].
            beats: be the operator's heartbeat; false where the operator has another one.

        Raises:
            BusError: the stack does not say what is running.
        """
        self._session, self._patience_s = session, patience_s
        self.heard: deque[OperatorAnswer] = deque(maxlen=_KEPT)
        self._commands: deque[OperatorCommand] = deque(maxlen=_KEPT)
        self._refusals: deque[tuple[str, str]] = deque(maxlen=_KEPT)
        self._arrived, self._turn = Condition(), Lock()
        session.subscribe("operator/command", self._on_command)
        session.subscribe("operator/answer", self._on_answer)
        session.subscribe(REFUSED, self._on_refusal)
        settings = build(Operator, ask_deployment(session).get("operator", {}), "operator")
        self.heartbeat_s = settings.heartbeat_s if beats else 0.0
        self._closed = Event()
        if self.heartbeat_s:
            self._session.put(BEAT, b"", lossless=False)
            Thread(target=self._beat, args=(settings.beat_s,), daemon=True).start()

    # Where to -------------------------------------------------------------------------------------------

    def direction(self, x: float, y: float) -> Answer:
        """Walk in a direction of the trunk, x ahead and y to the left, from -1 to 1; under way, after the step."""
        return self.say(f"direction {x:.3f} {y:.3f}")

    def halt(self) -> Answer:
        """Finish the step, then stand: the walk is over."""
        return self.say("halt")

    def pause(self) -> Answer:
        """Finish the step, then stand, ready to go on."""
        return self.say("pause")

    def resume(self) -> Answer:
        """Go on with the walk that was paused."""
        return self.say("resume")

    def step_once(self) -> Answer:
        """One step of a walk that is paused."""
        return self.say("step")

    # The foothold ---------------------------------------------------------------------------------------

    def skip_foothold(self) -> Answer:
        """Give up the foothold of the moment, take the next candidate."""
        return self.say("skip")

    def reprobe(self) -> Answer:
        """Press once more on the foothold under test, or try once more where none was found."""
        return self.say("reprobe")

    # Postures and stops ---------------------------------------------------------------------------------

    def stand(self) -> Answer:
        """Get up, or end the walk and stand."""
        return self.say("stand")

    def sit(self) -> Answer:
        """A leg in the air is put down; the robot sits down and is damped."""
        return self.say("sit")

    def stop(self) -> Answer:
        """The leg goes back at once to where it stood; the robot stands, the walk is over."""
        return self.say("stop")

    def damp(self) -> Answer:
        """Brake every joint: the robot sinks. After a cut nothing else gets it up."""
        return self.say("damp")

    def cut(self) -> Answer:
        """No torque at once: the robot falls."""
        return self.say("cut")

    # All of them ----------------------------------------------------------------------------------------

    def say(self, words: str) -> Answer:
        """Say a command and wait for what becomes of it."""
        with self._turn:
            number = self._next_number()
            self._session.put(REQUEST, words.encode())
            return self._await(words, number)

    def close(self) -> None:
        """End the heartbeat: a robot that asks for one sits down."""
        self._closed.set()

    def _await(self, words: str, number: int) -> Answer:
        end = time.monotonic() + self._patience_s
        with self._arrived:
            while True:
                if (answer := self._answer_to(words, number)) is not None:
                    return answer
                if not self._arrived.wait(end - time.monotonic()) or time.monotonic() >= end:
                    break
        return refused(
            f"{words}: no answer in {self._patience_s:g} s: is fsm running, does simulated time go on? "
            "`surefoot status` tells"
        )

    def _answer_to(self, words: str, number: int) -> Answer | None:
        """What has been answered to a command that was said when the next one had at least this number."""
        for request, why in self._refusals:
            if request == words:
                self._refusals.clear()
                return refused(why)
        own = next((each.seq for each in self._commands if each.seq >= number and each.command == words), None)
        answer = next((each for each in self.heard if each.number == own), None)
        return None if answer is None else Answer(answer.taken, answer.words)

    def _next_number(self) -> int:
        with self._arrived:
            self._refusals.clear()
            return self._commands[-1].seq + 1 if self._commands else 0

    def _on_command(self, key: str, payload: bytes) -> None:
        with suppress(MessageError), self._arrived:
            self._commands.append(decode(OperatorCommand, payload))
            self._arrived.notify_all()

    def _on_answer(self, key: str, payload: bytes) -> None:
        with suppress(MessageError), self._arrived:
            self.heard.append(decode(OperatorAnswer, payload))
            self._arrived.notify_all()

    def _on_refusal(self, key: str, payload: bytes) -> None:
        with suppress(ValueError, TypeError), self._arrived:
            self._refusals.append(unpack_refusal(payload))
            self._arrived.notify_all()

    def _beat(self, every_s: float) -> None:
        while not self._closed.wait(every_s):
            self._session.put(BEAT, b"", lossless=False)
