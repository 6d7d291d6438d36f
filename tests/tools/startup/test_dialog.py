"""The dialog with scripted answers, a stack in simulated time and the emulator over real sockets."""

from contextlib import contextmanager

import pytest
from emulation import PATIENT, emulator

from surefoot.bus.messages import ProcessStatus
from surefoot.components.lockstep import Lockstep
from surefoot.config.aliengo import Aliengo
from surefoot.config.deployment import Deployment, Run
from surefoot.config.emulator import Emulator
from surefoot.config.fsm import Fsm
from surefoot.config.hw import Hw
from surefoot.tools.picture import Picture
from surefoot.tools.startup.dialog import READY, Dialog
from surefoot.tools.startup.readiness import Readiness

HOLDS_ROBOT = ("io", "estimator", "wbc", "fsm")
STREAMS = {"hw/state": "hardware", "state/estimate": "estimate", "fsm/reference": "reference"}
LOOK_S = 0.1
LIES, HANGS = ["l", "y", "y"], ["h", "y", "y"]


class StartUp:
    """A person with a script, at a robot that lies.

    Attributes:
        said: to the person; `states` that the robot went through.
    """

    def __init__(self, deployment):
        self.stack, self.picture, self.said, self.commands = Lockstep(deployment, HOLDS_ROBOT), Picture(), [], []
        self.stack.listen(self._hear)
        for name in self.picture.processes:
            self.picture.note_status(ProcessStatus(process=name, life="RUN"))
        readiness = Readiness(deployment.load_robot(), deployment.doctor)
        self.dialog = Dialog(readiness, self.said.append, self._command)

    def _hear(self, key, message):
        if key == "fsm/event":
            self.picture.note_event(message)
        elif key in STREAMS:
            setattr(self.picture, STREAMS[key], message)

    def _command(self, command):
        self.commands.append(command)
        self.stack.command(command)

    @property
    def asked(self):
        return [words for words in self.said if words.endswith("/n]")]

    @property
    def states(self):
        return list(dict.fromkeys(event.state for event in self.picture.events if event.kind == "transition"))

    def look(self, line=None):
        self.dialog.look(self.picture, line)
        self.stack.run(self.stack.t + LOOK_S)

    def run(self, answers, until=lambda: False):
        """Answer each question once, until the dialog is over, `until()` holds, or a question has no answer."""
        self.look()
        answered = 0
        while not self.dialog.over and not until():
            if len(self.asked) > answered:
                if answered == len(answers):
                    return
                self.look(answers[answered])
                answered += 1
            else:
                self.look()
            assert self.stack.t < 60.0, self.said


@contextmanager
def start_up():
    wire = Aliengo(exchange="cycle", **PATIENT)
    asked = Deployment(
        run=Run(command=""),
        hw=Hw(backend="aliengo", start="lying", aliengo=wire),
        fsm=Fsm(hold_s=0.5),
        emulator=Emulator(pace="packets"),
    )
    with emulator(asked) as there:
        made = StartUp(there.deployment)
        made.robot = there.robot
        try:
            yield made
        finally:
            made.stack.components["io"].robot.close()


def test_with_yes_to_all_a_robot_that_lies_is_held_and_stands():
    with start_up() as made:
        made.run(LIES)
        assert made.dialog.over and made.said[-1] == READY
        assert made.states == ["HOLD", "STAND_UP", "STAND"] and made.commands == ["hold", "stand"]
        assert made.robot.plant.truth().p_WB[2] > 0.3
    assert [words.split("?")[0].split(" ")[0] for words in made.asked] == ["Does", "Bring", "Stand"]


def test_one_that_hangs_is_held_and_folded_and_has_to_lie_to_stand():
    with start_up() as made:
        made.run(HANGS)
        for _ in range(10):
            made.look()  # a person lets it down
        made.look("y")
        made.look()
        assert not made.dialog.over and made.asked[-1].startswith("Bring up the gains? It is held as it lies")
    assert made.commands == ["hold", "sit"] and made.states == ["HOLD", "SIT_DOWN", "DAMP"]


@pytest.mark.parametrize(
    ("answers", "commands"),
    [(["n"], []), (["l", "n"], []), (["l", "y", "n"], ["hold", "damp"]), (["h", "y", "n"], ["hold", "damp"])],
)
def test_no_leaves_it_damped_at_every_point(answers, commands):
    with start_up() as made:
        made.run(answers)
        assert made.dialog.over and made.commands == commands and "amped" in made.said[-1]
        made.stack.run(made.stack.t + 0.1)
        assert made.picture.state == "DAMP"


def test_enter_while_it_moves_damps_it():
    with start_up() as made:
        made.run(LIES, until=lambda: made.picture.state == "STAND_UP")
        made.look("")
        assert made.dialog.over and made.commands[-1] == "damp" and made.picture.state == "DAMP"


def test_one_that_others_damp_meanwhile_is_not_asked_for_more():
    with start_up() as made:
        made.run(["l", "y"])
        assert made.picture.state == "HOLD" and made.asked[-1].startswith("Stand up?")
        made.stack.command("damp")
        made.look()
        made.look("y")
        assert made.dialog.over and made.said[-1].startswith("The robot was damped: commanded")
        assert made.commands == ["hold"]


def test_what_is_no_answer_moves_nothing():
    with start_up() as made:
        made.run(["l"])
        for line in ("", "yes", "hy"):
            made.look(line)
        assert made.commands == [] and made.said[-1] == "please answer y/n"
