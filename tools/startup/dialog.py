"""Walks a person through the first minute: damping, a hold, standing; asks before each motion."""

from __future__ import annotations

from collections.abc import Callable, Generator
from typing import TypeVar

from surefoot.bus.messages import FsmEvent
from surefoot.tools.picture import Picture
from surefoot.tools.startup.readiness import Readiness

_Answer = TypeVar("_Answer")
_Talk = Generator[None, None, _Answer]

READY = (
    "It stands. `surefoot command forward` in another terminal sends it on, sit puts it down, damp lets it go and "
    "ends the run."
)


class _Over(Exception):
    """The dialog ends before the robot stands; says why."""


class Dialog:
    """Asked again and again what there is to do; it never waits itself.

    Every question can be answered by n, which leaves the robot damped. While the robot moves, Enter damps it.

    Attributes:
        over: there is nothing more to ask.
    """

    def __init__(self, readiness: Readiness, say: Callable[[str], None], command: Callable[[str], None]):
        """For one run.

        Args:
            readiness: says no.
            say: a line to the person.
            command: an operator's command to the robot.
        """
        self._readiness, self._say, self._command = readiness, say, command
        self._picture, self._typed = Picture(), ""
        self._pressed = False
        self._seen = 0
        self._state = "DAMP"  # of the robot, by its events
        self._to_be_damped = False
        self.over = False
        self._talk = self._start_up()

    def look(self, picture: Picture, line: str | None) -> None:
        """Go on as far as it goes.

        Args:
            picture: what has been heard of the run.
            line: that was typed since the last look; None: nothing was.
        """
        self._picture, self._pressed = picture, line is not None
        self._typed = (line or "").strip().lower()
        self._readiness.look(picture)
        try:
            next(self._talk)
        except StopIteration:
            self.over = True
        except _Over as end:
            self._say(str(end))
            self.over = True

    # The way ---------------------------------------------------------------------------------------------

    def _start_up(self) -> _Talk[None]:
        yield from self._all_up()
        self._say(
            "All processes are up, the robot is damped. Every question can be answered by n: it stays damped."
        )
        place = yield from self._ask(
            "Does it hang (h) with its feet in the air, or lie (l) folded on its belly?", "hl"
        )
        if place == "h":
            yield from self._hang()
        yield from self._hold("Bring up the gains? It is held as it lies, nothing is to move.", lies=True)
        yield from self._agree("Stand up? Everybody clear of its legs; Enter damps it while it moves.", lies=True)
        yield from self._move("stand", "STAND")
        self._say(READY)

    def _hang(self) -> _Talk[None]:
        """What can be tried in the air; to stand it has to lie."""
        yield from self._hold(
            "Bring up the gains? Its legs are held as they hang, nothing is to move.", lies=False
        )
        self._say("Push a foot gently: each leg is to spring back, none is to tremble.")
        yield from self._agree("Fold its legs, to let it down? Enter damps it while they move.", lies=False)
        yield from self._move("sit", "DAMP")
        yield from self._ask("Let it down on its belly. Does it lie?", "y")

    def _hold(self, question: str, lies: bool) -> _Talk[None]:
        yield from self._agree(question, lies)
        yield from self._move("hold", "HOLD")
        while self._picture.state != "HOLD" or self._rises:
            yield from self._watch_motion()
        self._say("It is held, its gains are up.")

    # Its parts -------------------------------------------------------------------------------------------

    def _all_up(self) -> _Talk[None]:
        told = ""
        while words := self._readiness.awaited(self._picture):
            if words != told:
                self._say(f"waiting for {words}")
            told = words
            yield from self._pause()

    def _agree(self, question: str, lies: bool) -> _Talk[None]:
        """Ask for a motion, unless something speaks against it: then again once that is mended."""
        while True:
            while refusal := self._readiness.refusal(self._picture, lies):
                self._say(f"Not yet: {refusal}.")
                yield from self._ask("Look again?", "y")
            yield from self._ask(question, "y")
            if not self._readiness.refusal(self._picture, lies):  # it may have changed meanwhile
                return

    def _ask(self, question: str, answers: str) -> _Talk[str]:
        """One of the letters in `answers`; n ends the dialog."""
        choice = "/".join((*answers, "n"))
        self._say(f"{question} [{choice}]")
        while True:
            yield from self._pause()
            if self._typed == "n":
                self._leave()
            if self._typed and self._typed in answers:
                return self._typed
            if self._pressed:
                self._say(f"please answer {choice}")

    def _move(self, command: str, target: str) -> _Talk[None]:
        """Command, until the robot is in a state."""
        self._to_be_damped = target == "DAMP"
        self._command(command)
        self._state = ""
        while self._state != target:
            yield from self._watch_motion()
        self._to_be_damped = False

    @property
    def _rises(self) -> bool:
        """Gains come up."""
        reference = self._picture.reference
        return reference is not None and reference.t < reference.joint_t1

    def _watch_motion(self) -> _Talk[None]:
        yield from self._pause()
        if self._pressed:
            self._command("damp")
            raise _Over("Damped at your word.")

    def _pause(self) -> _Talk[None]:
        """Until the next look; a robot that has been damped by something else ends the dialog."""
        yield
        new, self._seen = self._picture.events[self._seen :], len(self._picture.events)
        for event in new:
            self._hear(event)

    def _hear(self, event: FsmEvent) -> None:
        if event.kind == "refused":
            raise _Over(f"The robot refuses: {event.reason}")
        if event.kind != "transition":
            return
        self._state = event.state
        if event.state == "DAMP" and not self._to_be_damped:
            raise _Over(f"The robot was damped: {event.reason}. See docs/first_steps_on_the_robot.md")

    def _leave(self) -> None:
        """The answer was no."""
        if self._picture.state == "HOLD":
            self._command("damp")
            raise _Over("Damped; the run ends.")
        raise _Over("The robot stays damped; `surefoot command stand` in another terminal gets it up.")
