"""What a recording holds besides the topics: which inputs each step read, and states to begin a replay from."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from surefoot.bus.message import Message, array, flag, integer, names, text

STEPS, CHECKPOINT = "steps", "checkpoint"
"""Key prefixes in a recording; the process's name follows."""


@dataclass(frozen=True, eq=False, kw_only=True)
class StepLog(Message):
    """`steps/NAME`: some successive steps of a process and the messages that were new to each."""

    process: str = text("its name")
    first_step: int = integer("index of the first step here since the process began")
    release_t: np.ndarray = array(-1, doc="release time of each step", unit="s")
    inputs: tuple[str, ...] = names("topics that the process reads")
    read_step: np.ndarray = array(-1, dtype="int64", doc="of each message read: the step, counted in this log")
    read_input: np.ndarray = array(-1, dtype="int64", doc="its topic, an index into `inputs`")
    read_boot: np.ndarray = array(-1, dtype="int64", doc="its `boot`")
    read_seq: np.ndarray = array(-1, dtype="int64", doc="its `seq`")


@dataclass(frozen=True, eq=False, kw_only=True)
class Checkpoint(Message):
    """`checkpoint/NAME`: all that a process carries from one step to the next."""

    process: str = text("its name")
    step: int = integer("how many steps it had made since it began")
    active: bool = flag("it steps; false: it still waits for healthy inputs")
    fresh: bool = flag("a component as it was made: there is no state to restore")
    state: np.ndarray = array(-1, dtype="uint8", doc="packed snapshot of the component")
    inputs: tuple[str, ...] = names("topics of which it had a latest message")
    latest: np.ndarray = array(-1, dtype="uint8", doc="these messages, one after the other, encoded")
    latest_size: np.ndarray = array(-1, dtype="int64", doc="bytes of each")
    outputs: tuple[str, ...] = names("topics that it publishes")
    next_seq: np.ndarray = array(-1, dtype="int64", doc="number of the next message on each")
    writes_boot: int = integer("`boot` of these messages: one that has relieved another goes on with its")

    def latest_payloads(self) -> dict[str, bytes]:
        """The encoded latest message of each topic in `inputs`."""
        ends, raw = np.cumsum(self.latest_size), self.latest.tobytes()
        begins = ends - self.latest_size
        return {key: raw[a:b] for key, a, b in zip(self.inputs, begins, ends, strict=True)}
