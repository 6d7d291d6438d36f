"""What io itself sees to of what people ask for, whatever becomes of the other processes."""

from __future__ import annotations

from surefoot.bus.messages import JointCommand, OperatorCommand
from surefoot.components.fsm.words import WALK_WORDS
from surefoot.hw.gate.gate import Gate
from surefoot.hw.robot_interface import Stop

_WORDS = {"settle": "sit", "cut": "cut"}
_REMOTE = "buttons of the remote"


class OperatorHand:
    """Takes the torque away in the cycle that it is told to, and damps a robot that does not sit down as told.

    Attributes:
        said: commands that were given at the robot itself, for the operator's desk to pass on and to take away.
    """

    def __init__(self, gate: Gate, settle_s: float):
        """`settle_s`: how long the robot may still be driven after it was told to sit [s]."""
        self._gate, self._settle_s = gate, settle_s
        self.said: list[str] = []
        self._held: Stop = ""
        self._sits_since: float | None = None

    def feel(self, stop: Stop) -> None:
        """What is held on the remote now; a person who goes on holding it says it once."""
        if stop and stop != self._held:
            self.said.append(f"{_WORDS[stop]}: {_REMOTE}")
            if stop == "cut":
                self._gate.cut(_REMOTE)
        self._held = stop

    def hear(self, message: OperatorCommand, t: float) -> None:
        """A command at time `t` [s]; the state machine hears it as well."""
        if message.word == "cut":
            self._gate.cut(message.why or "by command")
        elif message.word == "damp":
            self._gate.free()
        if message.word == "sit":
            self._sits_since = t if self._sits_since is None else self._sits_since
        elif message.word not in WALK_WORDS:  # those do not take a sit back
            self._sits_since = None

    def watch(self, command: JointCommand | None, t: float) -> None:
        """Look whether the robot is still driven at time `t` [s] though it should sit by now."""
        if self._sits_since is None or t - self._sits_since < self._settle_s:
            return
        self._sits_since = None
        if command is not None and (command.kp.any() or command.tau.any()):
            self._gate.damp(f"told to sit {self._settle_s:g} s ago and still driven: is fsm running?")
