"""The words that an operator may say, and the answer to one."""

from __future__ import annotations

from dataclasses import dataclass
from math import hypot, isfinite

DIRECTIONS = {"forward": (1.0, 0.0), "backward": (-1.0, 0.0), "left": (0.0, 1.0), "right": (0.0, -1.0)}
"""Commanded directions in the base frame."""

MEANINGS = {
    "stand": "get up, or end the walk and stand",
    "sit": "a leg in the air is put down, the robot sits down and is damped",
    "forward": "walk ahead; under way, after the step",
    "backward": "walk back; under way, after the step",
    "left": "walk to the left; under way, after the step",
    "right": "walk to the right; under way, after the step",
    "direction": "X Y: walk in this direction of the trunk, x ahead, y to the left; under way, after the step",
    "halt": "finish the step, then stand; the walk is over",
    "pause": "finish the step, then stand; resume goes on",
    "resume": "go on with the walk that was paused",
    "step": "one step of the walk that is paused; under way, pause after this one",
    "skip": "give up the foothold of the moment, take the next candidate",
    "reprobe": "press once more on the foothold under test; or try once more where no foothold was found",
    "stop": "the leg goes back at once to where it stood; the robot stands, the walk is over",
    "hold": "a damped robot is held where it lies",
    "damp": "brake every joint; the robot sinks",
    "cut": "no torque at once; the robot falls",
}
"""What the robot does, of everything that an operator may ask for."""

COMMANDS = tuple(MEANINGS)

WALK_WORDS = ("halt", "pause", "resume", "step", "skip", "reprobe")
"""Of a robot that walks, or rests on its walk."""

PAUSED = "commanded pause"
"""Why a walk rests that can go on; in the reference, and on every screen."""

LEAST_LENGTH = 0.1
"""Of a direction: a shorter one is rather a slip of the hand than a wish."""

MOST = 1.0
"""Of each part of a direction: it is no distance."""


class NoCommand(ValueError):
    """Words that are no command; says what would be right."""


@dataclass(frozen=True)
class Command:
    """What is asked for.

    Attributes:
        word: one of `COMMANDS`.
        asked: all that was said, but for the reason that a person has not typed.
        direction_B: unit vector of the walk in the base frame; None of a word that is no direction.
    """

    word: str
    asked: str
    direction_B: tuple[float, float] | None = None


@dataclass(frozen=True)
class Answer:
    """What becomes of a command.

    Attributes:
        taken: it is obeyed, now or as soon as the step is over.
        words: what the robot does, or why it does not, and what would help.
    """

    taken: bool
    words: str


def taken(words: str) -> Answer:
    """The robot obeys."""
    return Answer(True, words)


def refused(words: str) -> Answer:
    """The robot does not obey."""
    return Answer(False, words)


def read_command(text: str) -> Command:
    """The command in `WORD`, `direction X Y`, or either with its reason after a colon.

    Raises:
        NoCommand: it is none; says what would be.
    """
    asked = text.partition(": ")[0]
    word, *figures = asked.split()[:4] or [""]
    if word not in COMMANDS:
        raise NoCommand(f"unknown command {text!r}; commands are {', '.join(COMMANDS)}")
    if word == "direction":
        return Command(word, asked, _direction(figures))
    if figures:
        raise NoCommand(f"{asked!r}: {word} takes no figures; say {word} alone")
    return Command(word, asked, DIRECTIONS.get(word))


def is_direction(text: str) -> bool:
    """Whether a command sends the robot somewhere."""
    word = text.partition(": ")[0].partition(" ")[0]
    return word in DIRECTIONS or word == "direction"


def _direction(figures: list[str]) -> tuple[float, float]:
    said = " ".join(["direction", *figures])
    try:
        x, y = map(float, figures)
    except ValueError:
        raise NoCommand(f"{said}: want two numbers, x ahead and y to the left, such as 0.7 -0.7") from None
    if not (isfinite(x) and isfinite(y)) or max(abs(x), abs(y)) > MOST:
        raise NoCommand(f"{said}: each number from -{MOST:g} to {MOST:g}; only the direction counts")
    length = hypot(x, y)
    if length < LEAST_LENGTH:
        raise NoCommand(f"{said}: {length:.2f} long, at least {LEAST_LENGTH}; say halt to stand")
    return x / length, y / length
