"""After a leg has gone back the operator sees what became of each candidate."""

from walker import Walker

from surefoot.bus.messages import FsmEvent
from surefoot.config.fsm import Fsm as Settings
from surefoot.tools.teleop.candidates import Candidates

RL = 2


class Told(Walker):
    """Its events go to the table."""

    def __init__(self, **settings):
        self.table = Candidates()
        super().__init__(Settings(**settings))

    def _hear(self, key, message):
        super()._hear(key, message)
        if isinstance(message, FsmEvent):
            self.table.note(message)


def test_every_candidate_has_its_force_displacement_and_verdict():
    robot = Told(alternatives=1, probe_around=False, put_off=False)
    robot.come_to("PROBE")
    robot.run(0.35)
    robot.sunk[RL] = 0.04
    robot.come_to("MOVE")
    assert robot.tell("skip").taken
    robot.come_to("RETURN_SAFE")
    robot.come_to("STOPPED")
    turn = robot.table.given_up
    assert turn.leg == RL and turn.end == "no safe foothold among the alternatives"
    first, second = turn.candidates
    assert (first.number, second.number) == (0, 1)
    assert first.held_n > 59.0 and first.asked_n > first.held_n and 0.039 < first.displacement_m < 0.041
    assert first.verdict.startswith("collapsed: the foot moved 4.0 cm") and not first.accepted
    assert second.verdict == "given up: skipped by command" and second.asked_n == 0.0


def test_a_leg_that_stands_has_given_nothing_up():
    robot = Told(probe_around=False)
    assert robot.run(20.0, lambda: robot.table.turn is not None and robot.table.turn.accepted)
    only = robot.table.turn.candidates
    assert len(only) == 1 and only[0].held_n > 99.0 and only[0].verdict == "accepted: all forces were borne"
    robot.come_to("MOVE")
    assert robot.table.given_up is None and robot.table.turn.leg != RL
