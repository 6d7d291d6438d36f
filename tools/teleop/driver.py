"""`surefoot drive`: keys to commands, and a screen of what comes of them."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from threading import Lock, Thread

from rich.console import Console, RenderableType
from rich.live import Live

from surefoot.bus.session import Session
from surefoot.components.deployment_desk import ask_deployment
from surefoot.components.fsm.words import PAUSED, Answer
from surefoot.tools.stack_watch import StackWatch
from surefoot.tools.teleop.candidates import Candidates
from surefoot.tools.teleop.drive_screen import SURE_TO_CUT, Said, drive_screen
from surefoot.tools.teleop.keys import ARROWS, KEYS, LEAVE, SURE
from surefoot.tools.teleop.raw_terminal import RawTerminal
from surefoot.tools.teleop.remote import Remote

_DRAW_S = 0.2
_KEEPS = 32  # lines of what was answered


class Driver:
    """What a person at the keys has said, and what became of it.

    Attributes:
        leaves: the person is done.
        question: waits for the next key; empty when none does.
    """

    def __init__(self, ask: Callable[[str], Callable[[], Answer]], paused: Callable[[], bool]):
        """For one robot.

        Args:
            ask: says a command; what it returns waits for the answer.
            paused: whether the walk rests and can go on, for the one key that says both.
        """
        self._ask, self._paused = ask, paused
        self.leaves, self.question = False, ""
        self._lock = Lock()
        self._said: list[Said] = []
        self._last = ""

    @property
    def said(self) -> Sequence[Said]:
        """Commands and their answers, newest last."""
        with self._lock:
            return self._said.copy()

    @property
    def waits(self) -> bool:
        """Whether an answer is still to come."""
        with self._lock:
            return any(answer is None for _, answer in self._said)

    def press(self, key: str) -> None:
        """A key; one that is held says its command again only when that was answered."""
        key = ARROWS.get(key, key)
        words = KEYS[key].words if key in KEYS else ""
        asked, self.question = self.question, ""
        if words == "stop":
            self.say(words)  # whatever was asked before
        elif asked:
            if key == SURE:
                self.say("cut")
        elif key == LEAVE:
            self.leaves = True
        elif words == "cut":
            self.question = SURE_TO_CUT
        elif words:
            self.say("resume" if words == "pause" and self._paused() else words)

    def say(self, words: str) -> None:
        """Say a command at once, in the order of the calls; no answer keeps the next one, which may be a stop.

        What was said last and is not answered yet is not said again.
        """
        with self._lock:
            if words == self._last and (words, None) in self._said:
                return
            self._last = words
            self._said.append((words, None))
            del self._said[:-_KEEPS]
        Thread(target=self._wait, args=(words, self._ask(words)), daemon=True).start()

    def _wait(self, words: str, answered: Callable[[], Answer]) -> None:
        answer = answered()
        with self._lock:
            if (words, None) in self._said:
                self._said.remove((words, None))
            self._said.append((words, answer))


class _Cabin:
    """The robot that is driven, as far as it is heard, and the remote in the driver's hand."""

    def __init__(self, connect: Callable[[], Session]):
        self._session = connect()
        self.watch = StackWatch(connect)
        self.remote = Remote(self._session)
        self.driver = Driver(self.remote.ask, lambda: self._state == ("STOPPED", PAUSED))
        self._candidates, self._events = Candidates(), 0
        fsm = ask_deployment(self._session).get("fsm", {})
        self._alternatives: int | None = fsm.get("alternatives")

    @property
    def _state(self) -> tuple[str, str]:
        reference = self.watch.picture.reference
        return (reference.state, reference.reason) if reference is not None else ("", "")

    def look(self) -> None:
        self.watch.look()
        events = self.watch.picture.events
        for event in events[self._events :]:
            self._candidates.note(event)
        self._events = len(events)

    def drawn(self) -> RenderableType:
        beats = ", heartbeat" if self.remote.heartbeat_s else ""
        title = f"Surefoot drive, {self.watch.where}{beats}"
        driver = self.driver
        picture = self.watch.picture
        return drive_screen(picture, self._candidates, self._alternatives, driver.said, title, driver.question)

    def close(self) -> None:
        self.remote.close()
        self.watch.close()
        self._session.close()


def drive(connect: Callable[[], Session], descriptor: int, console: Console) -> str:
    """Drive until the person leaves, the terminal is gone, or the stack ends.

    Args:
        connect: opens the bus.
        descriptor: of the terminal that is typed at.
        console: that is drawn on.

    Returns:
        Why it is over, in words; empty when the person has left.

    Raises:
        BusError: no stack runs there.
    """
    cabin = _Cabin(connect)
    try:
        with RawTerminal(descriptor) as terminal, Live(console=console, screen=True, auto_refresh=False) as live:
            drawn = 0.0
            while not (cabin.driver.leaves or cabin.watch.ended or terminal.closed):
                pressed = terminal.keys(_DRAW_S / 4.0)
                for key in pressed:
                    cabin.driver.press(key)
                cabin.look()
                if pressed or time.monotonic() - drawn > _DRAW_S:
                    drawn = time.monotonic()
                    live.update(cabin.drawn(), refresh=True)
    except KeyboardInterrupt:
        return ""
    finally:
        cabin.close()
    return cabin.watch.ended
