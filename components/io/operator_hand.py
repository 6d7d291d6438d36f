"""What io itself sees to of what people ask for, whatever becomes of the other processes."""

from __future__ import annotations

from surefoot.bus.messages import JointCommand, OperatorCommand
from surefoot.components.fsm.words import NoCommand, read_command
from surefoot.hw.gate.gate import Gate
from surefoot.hw.robot_interface import Stop

_WORDS = {"settle": "sit", "cut": "cut"}
_REMOTE = "buttons of the remote"
_SETTLES = ("sit", "damp")


class OperatorHand:
    """Takes the torque away in the cycle that it is told to, and damps a robot that does not settle as told.

    Attributes:
        said: commands that were given at the robot itself, for the operator's desk to pass on and to take away.
    """

    def __init__(self, gate: Gate, settle_s: float):
        """`settle_s`: how long the robot may still be driven after it was told to sit, or to damp [s]."""
        self._gate, self._settle_s = gate, settle_s
        self.said: list[str] = []
        self._held: Stop = ""
        self._settles_since: float | None = None
        self._driven = False

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
        if message.word in _SETTLES:
            self._settles_since = t if self._settles_since is None else self._settles_since
        elif self._moves_again(message.word):
            self._settles_since = None

    def watch(self, command: JointCommand | None, t: float) -> None:
        """Look whether the robot is still driven at time `t` [s] though it should be damped by now."""
        self._driven = command is not None and bool(command.kp.any() or command.tau.any())
        if self._settles_since is None or t - self._settles_since < self._settle_s:
            return
        self._settles_since = None
        if self._driven:
            self._gate.damp(f"told to settle {self._settle_s:g} s ago and still driven: is fsm running?")

    def _moves_again(self, said: str) -> bool:
        """Whether the state machine obeys a word by driving the robot on; it holds one that is damped already."""
        try:
            command = read_command(said)
        except NoCommand:
            return False
        if command.word == "hold":
            return not self._driven
        return command.word in ("stand", "stop") or command.direction_B is not None
