"""The estimator against a simulated robot that sways on its feet, and its parts against closed forms."""

from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

from surefoot.bus.codec import encode
from surefoot.bus.messages import ControlMode, HardwareState, JointCommand, LegStatus, MotionReference
from surefoot.components.clock_messages import pack_snapshot
from surefoot.components.component import Inbox, Outbox
from surefoot.components.estimator.contact_detector import ContactDetector
from surefoot.components.estimator.contact_force import ContactForce
from surefoot.components.estimator.estimator import Estimator
from surefoot.components.estimator.surface_normal import SurfaceNormal
from surefoot.components.io.io import Io
from surefoot.components.robot_model import LegKinematics, build_model, foot_frame_ids
from surefoot.components.robot_model.rotation import (
    exp_rotation,
    log_rotation,
    matrix_of,
    matrix_of_rpy,
    quaternion_of,
    rpy_of,
)
from surefoot.config.deployment import Deployment
from surefoot.config.estimator import Estimator as Settings
from surefoot.config.hw import Hw
from surefoot.config.robot import GRAVITY, load_robot

ROBOT = load_robot("aliengo")
LEGS = LegKinematics(ROBOT)
STAND_Q = np.tile(ROBOT.nominal.stand_q, 4)
NOTHING = np.zeros((4, 3))


def test_rotations_agree_with_pinocchio():
    rng = np.random.default_rng(0)
    for _ in range(50):
        phi = rng.normal(size=3)
        R = exp_rotation(phi)
        np.testing.assert_allclose(R, pin.exp3(phi), atol=1e-12)
        np.testing.assert_allclose(matrix_of(quaternion_of(R)), R, atol=1e-12)
        np.testing.assert_allclose(log_rotation(R), pin.log3(R), atol=1e-9)
        np.testing.assert_allclose(matrix_of_rpy(rpy_of(R)), R, atol=1e-12)
        np.testing.assert_allclose(rpy_of(R), pin.rpy.matrixToRpy(R), atol=1e-9)


def test_eq_7_returns_the_forces_that_balance_the_joint_torques():
    model = build_model(ROBOT)
    data = model.createData()
    rng = np.random.default_rng(1)
    forces_W = rng.normal(size=(4, 3)) * 20 + [0.0, 0.0, 60.0]
    R = exp_rotation(np.array([0.1, -0.2, 0.4]))
    q = pin.neutral(model)
    q[3:7] = np.roll(quaternion_of(R), -1)
    q[7:] = STAND_Q
    tau = pin.computeGeneralizedGravity(model, data, q).copy()
    pin.computeJointJacobians(model, data, q)
    for frame, force in zip(foot_frame_ids(model), forces_W, strict=True):
        pin.updateFramePlacements(model, data)
        tau -= pin.getFrameJacobian(model, data, frame, pin.LOCAL_WORLD_ALIGNED)[:3].T @ force
    eq7 = ContactForce(ROBOT, friction_speed=0.1)
    bias = eq7.bias(R, quaternion_of(R), np.zeros(3), STAND_Q, np.zeros(12))
    found_B = eq7.force(LEGS.jacobian(STAND_Q.reshape(4, 3)), tau[6:], bias)
    np.testing.assert_allclose(found_B @ R.T, forces_W, atol=1e-3)


def test_contact_needs_three_successive_hits():
    settings = Settings()
    detector = ContactDetector(settings)
    loud, quiet = np.full(4, settings.contact_on_n + 1), np.zeros(4)
    looks = settings.contact_every

    def feed(force, count):
        for _ in range(count * looks):
            contact = detector.update(force)
        return contact.copy()

    assert not feed(loud, 2).any()
    assert not feed(quiet, 1).any()
    assert not feed(loud, 2).any()
    assert feed(loud, 1).all()
    assert feed(np.full(4, 0.5 * (settings.contact_on_n + settings.contact_off_n)), 5).all()
    assert not feed(quiet, 3).any()


def test_the_normal_is_that_of_the_plane_through_the_feet():
    normal = SurfaceNormal(Settings())
    feet = np.array([[0.24, 0.14], [0.24, -0.14], [-0.24, 0.14], [-0.24, -0.14]])
    heights = 0.1 * feet[:, 0] - 0.2 * feet[:, 1] + 0.3
    for _ in range(500):
        found = normal.update(np.column_stack([feet, heights]))
    expected = np.array([-0.1, 0.2, 1.0]) / np.sqrt(1.05)
    np.testing.assert_allclose(found, expected, atol=1e-4)


class Loop:
    """Simulated robot and estimator, joints driven to a given base motion by a stiff motor law."""

    def __init__(self, seed=0):
        deployment = Deployment(hw=Hw(seed=seed))
        self.io, self.estimator = Io(deployment), Estimator(deployment)
        self.got = {}
        self.inboxes = Inbox(self.io.inputs), Inbox(self.estimator.inputs)
        self.outboxes = tuple(Outbox(part.outputs, self.got.__setitem__) for part in (self.io, self.estimator))
        self.p_BF = LEGS.position(STAND_Q.reshape(4, 3))
        self.cycle = 0

    def step(self, offset, phi, status=None):
        t = 0.002 * self.cycle
        self.cycle += 1
        q, _ = LEGS.inverse((self.p_BF - offset) @ exp_rotation(phi))
        one = np.ones(12)
        command = JointCommand(t=t, valid=True, q=q.ravel(), kp=300.0 * one, kd=8.0 * one)
        self.inboxes[0].deliver("joint/command", command)
        self.io.step(t, self.inboxes[0], self.outboxes[0])
        self.inboxes[1].deliver("hw/state", self.got["hw/state"])
        if status is not None:
            reference = MotionReference(t=t, valid=True, leg_status=status)
            self.inboxes[1].deliver("fsm/reference", reference)
        if self.estimator.activate(t, self.inboxes[1]):
            self.estimator.step(t, self.inboxes[1], self.outboxes[1])
        return self.got["state/estimate"], self.got["sim/truth"]


def sway(t):
    grow = min(1.0, 0.5 * t)
    offset = grow * np.array([0.03 * np.sin(2 * t), 0.03 * np.sin(1.5 * t), 0.02 * np.sin(2.5 * t)])
    return offset, grow * np.array([0.06 * np.sin(1.3 * t), 0.06 * np.sin(1.1 * t), 0.08 * np.sin(t)])


@pytest.mark.parametrize("seed", [0, 1])
def test_a_swaying_robot_knows_where_it_is(seed):
    loop = Loop(seed)
    tilt, position, velocity, force = [], [], [], []
    for cycle in range(3000):
        estimate, truth = loop.step(*sway(0.002 * cycle))
        error = log_rotation(matrix_of(estimate.quat_WB) @ matrix_of(truth.quat_WB).T)
        tilt.append(np.hypot(error[0], error[1]))
        position.append(estimate.p_WB - truth.p_WB)
        velocity.append(estimate.v_WB_W - truth.v_WB_W)
        force.append(estimate.force_W[:, 2] - truth.force_W[:, 2])
    assert estimate.valid and estimate.contact.all()
    assert np.degrees(np.max(tilt)) < 1.5
    assert np.abs(position).max() < 0.01
    assert np.sqrt(np.mean(np.square(velocity))) < 0.02
    assert np.sqrt(np.mean(np.square(force[500:]))) < 4.0
    assert estimate.covariance[0, 0] > 0.0


def test_a_reading_that_comes_again_changes_nothing():
    once, again, got, loop = Estimator(Deployment()), Estimator(Deployment()), {}, Loop()
    for cycle in range(200):
        loop.step(*sway(0.002 * cycle))
        state = loop.got["hw/state"]
        for name, estimator, times in (("once", once, 1), ("again", again, 1 + cycle % 4)):
            inbox, outbox = Inbox(estimator.inputs), Outbox(estimator.outputs, got.__setitem__)
            for late in range(times):
                rounded = replace(state, t=state.t + 1e-15 * late)
                inbox.deliver("hw/state", rounded)
                estimator.step(state.t + 0.002 * late, inbox, outbox)
                got[name, late] = encode(replace(got["state/estimate"], seq=0, t=state.t, force_W=NOTHING))
        assert all(got["again", late] == got["once", 0] for late in range(1 + cycle % 4))
    assert pack_snapshot(once.snapshot()) == pack_snapshot(again.snapshot())


def drift_when_a_foot_seems_to_sink(status):
    """Base drift when one foot's encoders say that it goes down by 5 cm while the robot stands still."""
    estimator = Estimator(Deployment())
    got = {}
    inbox, outbox = Inbox(estimator.inputs), Outbox(estimator.outputs, got.__setitem__)
    p_BF = LEGS.position(STAND_Q.reshape(4, 3))
    eq7 = ContactForce(ROBOT, 0.1)
    for cycle in range(400):
        t = 0.002 * cycle
        feet = p_BF.copy()
        feet[0, 2] -= 0.05 * min(max(t - 0.4, 0.0) / 0.3, 1.0)
        q, _ = LEGS.inverse(feet)
        bias = eq7.bias(np.eye(3), np.array([1.0, 0, 0, 0]), np.zeros(3), q.ravel(), np.zeros(12))
        tau = bias.reshape(4, 3) - (LEGS.jacobian(q).transpose(0, 2, 1) @ np.array([0.0, 0.0, 60.0]))
        state = HardwareState(t=t, valid=True, q=q.ravel(), tau=tau.ravel(), acc_B=np.array([0, 0, GRAVITY]))
        inbox.deliver("hw/state", state)
        inbox.deliver("fsm/reference", MotionReference(t=t, valid=True, leg_status=status))
        estimator.step(t, inbox, outbox)
        if cycle == 150:
            before = got["state/estimate"].p_WB
    return np.abs(got["state/estimate"].p_WB - before).max()


def test_a_foot_that_sinks_while_probed_does_not_drag_the_base():
    stance, probing = int(LegStatus.STANCE), int(LegStatus.PROBING)
    trusted = drift_when_a_foot_seems_to_sink(np.array([stance] * 4))
    probed = drift_when_a_foot_seems_to_sink(np.array([probing, stance, stance, stance]))
    assert probed < 2e-3
    assert trusted > probed


def speed_of_one_that_lies(seconds, mode=ControlMode.BALANCE, **state):
    """What is told of the base's speed when no foot feels the ground and the accelerometer is 0.05 m/s^2 off."""
    estimator = Estimator(Deployment())
    got = {}
    inbox, outbox = Inbox(estimator.inputs), Outbox(estimator.outputs, got.__setitem__)
    q = np.tile(ROBOT.nominal.lie_q, 4)
    for cycle in range(round(seconds / 0.002)):
        t = 0.002 * cycle
        acc_B = np.array([0.0, 0.0, GRAVITY + (0.05 if cycle else 0.0)])
        inbox.deliver("hw/state", HardwareState(t=t, valid=True, q=q, acc_B=acc_B, **state))
        inbox.deliver("fsm/reference", MotionReference(t=t, valid=True, mode=mode))
        estimator.step(t, inbox, outbox)
    assert not got["state/estimate"].contact.any()
    return np.abs(got["state/estimate"].v_WB_W).max()


def test_a_damped_robot_that_lies_on_its_belly_is_known_not_to_drift_away():
    assert speed_of_one_that_lies(3.0) > 0.1
    assert speed_of_one_that_lies(3.0, damping=True) < 0.01
    assert speed_of_one_that_lies(3.0, mode=ControlMode.DAMP) < 0.01
    assert speed_of_one_that_lies(3.0, mode=ControlMode.JOINT) < 0.01  # held where it is


def test_one_that_turns_or_falls_is_not_taken_to_lie_still():
    still = {"damping": True, "omega_WB_B": np.zeros(3)}
    turning = still | {"omega_WB_B": np.array([0.0, 0.0, 0.3])}
    assert speed_of_one_that_lies(1.0, **turning) > 2.0 * speed_of_one_that_lies(1.0, **still)


def test_it_waits_for_rest_and_says_so():
    estimator = Estimator(Deployment())
    inbox = Inbox(estimator.inputs)
    assert not estimator.activate(0.0, inbox)
    assert "is io running" in estimator.waiting_for(0.0, inbox)
    inbox.deliver("hw/state", HardwareState(t=0.0, valid=True, acc_B=np.array([0.0, 0.0, 3.0])))
    assert "must rest" in estimator.waiting_for(0.0, inbox)


def test_a_restarted_estimator_goes_on_to_the_last_bit():
    loop = Loop()
    for cycle in range(301):  # an odd number: half way between two looks of the contact detector
        loop.step(*sway(0.002 * cycle))
    again = Estimator(Deployment())
    again.restore(loop.estimator.snapshot())
    bytes_of = []
    for part in (loop.estimator, again):
        got = []
        outbox = Outbox(part.outputs, lambda key, message, got=got: got.append(encode(message)))
        inbox = Inbox(part.inputs)
        for cycle in range(loop.cycle, loop.cycle + 50):
            state = HardwareState(t=0.002 * cycle, valid=True, q=STAND_Q, acc_B=np.array([0.0, 0.0, GRAVITY]))
            inbox.deliver("hw/state", state)
            part.step(0.002 * cycle, inbox, outbox)
        bytes_of.append(got)
    assert len(bytes_of[0]) == 50 and bytes_of[0] == bytes_of[1]


def test_a_filter_that_diverges_says_so_once_and_keeps_place_and_heading():
    loop = Loop()
    for cycle in range(300):
        loop.step(*sway(0.002 * cycle))
    f = loop.estimator._filter
    f.R_WB = exp_rotation(np.array([0.0, 0.0, 0.7])) @ f.R_WB
    f.p_WB[:2] = [3.0, -2.0]
    f.P[2, 2] = 4.0
    estimate, _ = loop.step(*sway(0.6))
    assert not estimate.valid
    np.testing.assert_allclose(estimate.p_WB[:2], [3.0, -2.0], atol=0.05)
    w, _x, _y, z = estimate.quat_WB
    assert 2.0 * np.arctan2(z, w) == pytest.approx(0.7, abs=0.05)
    estimate, _ = loop.step(*sway(0.602))
    assert estimate.valid


def test_equal_seeds_give_equal_bytes():
    def trace(seed):
        loop = Loop(seed)
        for cycle in range(100):
            estimate, _ = loop.step(*sway(0.002 * cycle))
        return encode(estimate)

    assert trace(3) == trace(3)
    assert trace(3) != trace(4)
