"""What a supervisor and those who come to its run say to each other, outside the topic table."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field

import msgpack

NOTICE = "supervisor/notice"
"""Key of a `Notice`, published twice a second and given to whoever asks for it."""

ANSWER = "supervisor/answer"
"""Key prefix; the id of the process follows that asked to be lent one: gets an `Answer`."""


@dataclass(frozen=True)
class Post:
    """What the supervisor alone knows of one process of its run.

    Attributes:
        restarts: how often it has been started again; also the `boot` of its status.
        lent_to: id of the process that stands in for it; 0 the supervisor runs it itself.
        out: in words why none runs; empty while one does.
        silent_s: since it was last heard; -1 it has not been.
    """

    restarts: int = 0
    lent_to: int = 0
    out: str = ""
    silent_s: float = -1.0


@dataclass(frozen=True)
class Notice:
    """What a supervisor says of its run.

    Attributes:
        pid: of the supervisor.
        config: the deployment's file, an absolute path.
        settings: assignments `section.key=value` on top of it.
        processes: by name.
        notes: what the supervisor did last, oldest first.
        ending: in words why the run ends; empty while it goes on.
    """

    pid: int
    config: str
    settings: list[str]
    processes: dict[str, Post] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)
    ending: str = ""


@dataclass(frozen=True)
class Answer:
    """To one who asked to be lent a process.

    Attributes:
        boot: to run as; -1 it is not lent.
        words: why not.
    """

    boot: int
    words: str = ""


def pack_notice(notice: Notice) -> bytes:
    """Bytes of a notice."""
    return msgpack.packb(asdict(notice))


def unpack_notice(payload: bytes) -> Notice:
    """What `pack_notice` packed."""
    table = msgpack.unpackb(payload)
    return Notice(**table | {"processes": {name: Post(**post) for name, post in table["processes"].items()}})


def pack_answer(answer: Answer) -> bytes:
    """Bytes of an answer."""
    return msgpack.packb([answer.boot, answer.words])


def unpack_answer(payload: bytes) -> Answer:
    """What `pack_answer` packed."""
    return Answer(*msgpack.unpackb(payload))
