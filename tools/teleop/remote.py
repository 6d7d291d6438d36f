"""A remote control over the bus: a method for every command, the answer that came back, a heartbeat behind it."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable, Sequence
from contextlib import suppress
from threading import Condition, Event, Thread

from surefoot.bus.codec import decode
from surefoot.bus.errors import MessageError
from surefoot.bus.message import Message
from surefoot.bus.messages import OperatorAnswer, OperatorCommand, Tuning
from surefoot.bus.service_keys import BEAT, DEPLOYMENT, REFUSED, REQUEST, TUNE
from surefoot.bus.session import Session
from surefoot.components.deployment_desk import ask_deployment
from surefoot.components.fsm.words import Answer, refused
from surefoot.components.operator_desk import unpack_refusal
from surefoot.config.operator import Operator
from surefoot.config.tuning import shown
from surefoot.config.typed_toml import build

PATIENCE_S = 3.0
"""How long an answer is waited for; where simulated time is slow or stands, it comes late or never."""

_KEPT = 64


class Remote:
    """Commands the robot of a running stack.

    Every method says its command and waits for what becomes of it: an `Answer` that is taken or refused, in words.
    They may be called from any thread, and none waits for another: a stop goes out while an answer is awaited.
    Closing it, or losing its process, ends the heartbeat; the session is the caller's.

    Attributes:
        heard: the answers to all commands, whoever gave them, newest last.
        heartbeat_s: what the run asks for, where this is the heartbeat; else 0 [s].
    """

    def __init__(self, session: Session, patience_s: float = PATIENCE_S, beats: bool = True, settles: bool = True):
        """Listen to answers, and begin to beat where the run asks for a heartbeat.

        Args:
            session: of the bus.
            patience_s: how long an answer is waited for [s].
            beats: be the operator's heartbeat; false where the operator has another one, or who holds this remote
                beats himself.
            settles: wait until io has heard of what is listened to; false where the first word cannot wait. It
                follows the subscriptions on the same link.

        Raises:
            BusError: the stack does not say what is running.
        """
        self._session, self._patience_s = session, patience_s
        self.heard: deque[OperatorAnswer] = deque(maxlen=_KEPT)
        self._commands: deque[OperatorCommand] = deque(maxlen=_KEPT)
        self._refusals: deque[tuple[int, str, str]] = deque(maxlen=_KEPT)
        self._refused = 0
        self._tunings: deque[Tuning] = deque(maxlen=_KEPT)
        self._arrived = Condition()
        session.subscribe("operator/command", self._on_command)
        session.subscribe("operator/answer", self._on_answer)
        session.subscribe("operator/tuning", self._on_tuning)
        session.subscribe(REFUSED, self._on_refusal)
        self._closed, self.heartbeat_s = Event(), 0.0
        if beats:
            self._begin_to_beat(build(Operator, ask_deployment(session).get("operator", {}), "operator"))
        elif settles:
            session.ask(DEPLOYMENT)  # whoever answers has heard of the subscriptions: no answer comes too early

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

    # All of them, and settings --------------------------------------------------------------------------

    def say(self, words: str) -> Answer:
        """Say a command and wait for what becomes of it."""
        return self.ask(words)()

    def ask(self, words: str) -> Callable[[], Answer]:
        """Say a command; what is returned waits for what becomes of it."""
        with self._arrived:
            number, refusal = _next(self._commands), self._refused
        self._session.put(REQUEST, words.encode())
        return lambda: self._await(
            lambda: self._refusal_of(words, refusal) or self._answer_to(words, number),
            words,
            lambda: self._number_of(words, number) is not None,
        )

    def tune(self, key: str, value: float | bool | str | Sequence[float]) -> Answer:
        """Change a setting that is marked as tunable; taken between two steps of whoever goes by it.

        Args:
            key: its dotted path, such as "wbc.kp".
            value: the new one; a string as `--set` takes it.
        """
        assignment = f"{key}={value if isinstance(value, str) else shown(value)}"
        with self._arrived:
            number, refusal = _next(self._tunings), self._refused
        self._session.put(TUNE, assignment.encode())
        return self._await(lambda: self._refusal_of(assignment, refusal) or self._tuned(key, number), assignment)

    def beat(self) -> None:
        """One beat, of who knows himself when the operator is there."""
        self._session.put(BEAT, b"", lossless=False)

    def close(self) -> None:
        """End the heartbeat: a robot that asks for one sits down."""
        self._closed.set()

    def _await(
        self, answer: Callable[[], Answer | None], said: str, passed_on: Callable[[], bool] = lambda: False
    ) -> Answer:
        end = time.monotonic() + self._patience_s
        with self._arrived:
            while (found := answer()) is None:
                if not self._arrived.wait(end - time.monotonic()):
                    far = ", though io has passed it on" if passed_on() else ""
                    return refused(
                        f"{said}: no answer in {self._patience_s:g} s{far}: is fsm running, does simulated time "
                        "go on? `surefoot status` tells"
                    )
            return found

    def _refusal_of(self, request: str, since: int) -> Answer | None:
        """Why io's desk has not passed a request on; None if it has not said so."""
        whys = [why for count, each, why in self._refusals if count >= since and each == request]
        return refused(whys[0]) if whys else None

    def _answer_to(self, words: str, since: int) -> Answer | None:
        """What the state machine has answered to these words; None while it has not."""
        own = self._number_of(words, since)
        answer = next((each for each in self.heard if each.number == own), None)
        return None if answer is None else Answer(answer.taken, answer.words)

    def _number_of(self, words: str, since: int) -> int | None:
        """Under which io has passed these words on; None while it has not."""
        return next((each.seq for each in self._commands if each.seq >= since and each.command == words), None)

    def _tuned(self, key: str, since: int) -> Answer | None:
        """That a setting was changed; None while it was not."""
        changes = [each.assignment[-1] for each in self._tunings if each.seq >= since and each.assignment]
        own = next((each for each in changes if each.startswith(f"{key}=")), None)
        return None if own is None else Answer(True, f"{own} from the next step on")

    def _on_command(self, key: str, payload: bytes) -> None:
        with suppress(MessageError), self._arrived:
            command = decode(OperatorCommand, payload)
            if command.seq < _next(self._commands):
                self._commands.clear()  # another run
                self.heard.clear()
            self._commands.append(command)
            self._arrived.notify_all()

    def _on_answer(self, key: str, payload: bytes) -> None:
        with suppress(MessageError), self._arrived:
            self.heard.append(decode(OperatorAnswer, payload))
            self._arrived.notify_all()

    def _on_tuning(self, key: str, payload: bytes) -> None:
        with suppress(MessageError), self._arrived:
            tuning = decode(Tuning, payload)
            if tuning.seq < _next(self._tunings):
                self._tunings.clear()
            self._tunings.append(tuning)
            self._arrived.notify_all()

    def _on_refusal(self, key: str, payload: bytes) -> None:
        with suppress(ValueError, TypeError), self._arrived:
            self._refusals.append((self._refused, *unpack_refusal(payload)))
            self._refused += 1
            self._arrived.notify_all()

    def _begin_to_beat(self, settings: Operator) -> None:
        self.heartbeat_s = settings.heartbeat_s
        if self.heartbeat_s:
            self.beat()
            Thread(target=self._beat, args=(settings.beat_s,), daemon=True).start()

    def _beat(self, every_s: float) -> None:
        while not self._closed.wait(every_s):
            self.beat()


def _next(messages: Sequence[Message]) -> int:
    """The number after the last one."""
    return messages[-1].seq + 1 if messages else 0
