"""A damped robot is held where it is before it stands up; a joint that is driven away damps it."""

import numpy as np

from surefoot.bus.messages import ControlMode, OperatorCommand, StateEstimate
from surefoot.components.component import Inbox, Outbox
from surefoot.components.fsm.fsm import Fsm
from surefoot.config.deployment import Deployment
from surefoot.config.fsm import Fsm as Settings
from surefoot.config.robot import load_robot

LIES = np.tile(load_robot("aliengo").nominal.lie_q, 4)
TICK_S = 0.004


class Machine:
    """A state machine whose robot lies with its joints at `q`."""

    def __init__(self, hold_s=0.1):
        self.fsm = Fsm(Deployment(fsm=Settings(hold_s=hold_s)))
        self.inbox, self.sent = Inbox(self.fsm.inputs), {key: [] for key in self.fsm.outputs}
        self.outbox = Outbox(self.fsm.outputs, lambda key, message: self.sent[key].append(message))
        self.q, self.t = LIES.copy(), 0.0

    def __call__(self, *commands, seconds=TICK_S):
        """The newest reference after so long, in whose first step the commands come."""
        for command in commands:
            self.inbox.deliver("operator/command", OperatorCommand(t=self.t, valid=True, command=command))
        for _ in range(round(seconds / TICK_S)):
            self.t += TICK_S
            up = {"quat_WB": np.array([1.0, 0.0, 0.0, 0.0]), "normal_W": np.array([0.0, 0.0, 1.0])}
            estimate = StateEstimate(t=self.t, valid=True, q=self.q, p_WB=np.array([0.0, 0.0, 0.06]), **up)
            self.inbox.deliver("state/estimate", estimate)
            self.fsm.step(self.t, self.inbox, self.outbox)
            self.inbox.clear_new()
        return self.sent["fsm/reference"][-1]

    def said(self, kind):
        return [event.reason for event in self.sent["fsm/event"] if event.kind == kind]


def test_it_is_held_at_the_measured_posture_until_it_is_to_stand():
    machine = Machine()
    machine.q += 0.01
    held = machine("hold", seconds=0.5)
    assert held.state == "HOLD" and held.mode == ControlMode.JOINT
    np.testing.assert_array_equal(held.joint_from, machine.q)
    np.testing.assert_array_equal(held.joint_to, machine.q)
    assert machine("stand").state == "STAND_UP"


def test_a_joint_that_lies_beyond_its_range_is_held_at_the_end_of_it():
    machine = Machine()
    lower = np.array(load_robot("aliengo").position_range())[:, 0]
    machine.q[2] = lower[2] - 0.01
    assert machine("hold").joint_to[2] == lower[2]


def test_to_stand_the_gains_come_up_first():
    machine = Machine(hold_s=0.1)
    held = machine("stand")
    assert held.state == "HOLD" and held.joint_t1 - held.joint_t0 == 0.1
    assert machine(seconds=0.05).state == "HOLD" and machine(seconds=0.06).state == "STAND_UP"
    assert Machine(hold_s=0.0)("stand").state == "STAND_UP"


def test_a_joint_that_leaves_its_hold_damps_the_robot_and_is_named():
    machine = Machine()
    machine("stand", seconds=0.02)
    machine.q[4] += 0.2
    damped = machine()
    assert damped.state == "DAMP" and damped.reason == "FR_thigh left its hold by 0.20 rad, limit 0.15 rad"
    assert machine(seconds=1.0).state == "DAMP"


def test_it_is_let_go_by_damp_and_folds_its_legs_by_sit():
    machine = Machine()
    assert machine("hold", seconds=0.2).state == "HOLD" and machine("damp").state == "DAMP"
    machine("hold")
    assert machine("sit").state == "SIT_DOWN" and machine(seconds=1.0).state == "DAMP"


def test_only_a_damped_robot_is_held():
    machine = Machine(hold_s=0.0)
    machine("stand")
    assert machine("hold").state == "STAND_UP"
    assert machine.said("refused") == ["hold: the robot is not damped; command sit, or damp, first"]
