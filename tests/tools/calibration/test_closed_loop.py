"""The simulated robot is measured as a real one would be: what was drawn for it is found again."""

from dataclasses import replace

import mujoco
import numpy as np
import pytest
from emulation import PATIENT, emulator
from stands import standing_states

from surefoot.components.io import io as io_module
from surefoot.components.io.io import Io
from surefoot.config.aliengo import Aliengo
from surefoot.config.calibration import Calibration
from surefoot.config.deployment import Deployment, Run
from surefoot.config.emulator import Emulator, Wire
from surefoot.config.hw import Hw
from surefoot.config.robot import load_robot
from surefoot.config.unit import FootZero, Measured, Torque, Unit
from surefoot.hw.aliengo.remote import Button, Remote, StopChords
from surefoot.hw.calibrated_robot import CalibratedRobot
from surefoot.hw.mujoco.backend import MujocoRobot
from surefoot.hw.mujoco.plant import draw_plant
from surefoot.tools.calibration.hung import calibrate_hung, measure_hung
from surefoot.tools.calibration.hung_robot import HungRobot
from surefoot.tools.calibration.refusal import CannotCalibrate
from surefoot.tools.calibration.samples import samples_of
from surefoot.tools.calibration.standing import measure_standing

ROBOT = load_robot("aliengo")
NOBODY = Unit("aliengo")
OFFSET = np.linspace(-0.8, 0.7, 12)
MADE = Measured("2026-01-31T12:00+00:00", "standing", 4.0)
DATE = MADE.date
SHORT = Calibration(seconds=4.0)
HANDS_CLOSED = Button.L1 | Button.L2 | Button.R1 | Button.R2


def hung(calibration=SHORT, **settings):
    return Deployment(hw=Hw(**{"start": "hung", "seed": 5} | settings), calibration=calibration)


def answers(*words):
    """An operator who says these, and what was asked."""
    left, asked = list(words), []

    def ask(question):
        asked.append(question)
        return left.pop(0)

    return ask, asked


@pytest.fixture
def off_sensors(monkeypatch):
    """Robots whose torque estimates are off; the robots that were made."""
    made = []

    def make(deployment):
        made.append(MujocoRobot(deployment))
        wrong = Torque(MADE, tuple((-OFFSET).tolist()), (0.0,) * 12)
        return CalibratedRobot(made[-1], Unit("aliengo", torque=wrong))

    monkeypatch.setitem(io_module.BACKENDS, "mujoco", make)
    return made


def test_hung_up_offsets_noise_and_biases_are_found_and_applied_they_leave_nothing(off_sensors):
    deployment = hung()
    ask, asked = answers(True, False)
    result = calibrate_hung(deployment, NOBODY, 1, DATE, ask)
    unit, plant = result.unit, draw_plant(ROBOT, deployment.hw)
    samples = 500 * SHORT.seconds
    np.testing.assert_allclose(unit.torque.offset, OFFSET, atol=5.0 * 0.5 / np.sqrt(samples))
    np.testing.assert_allclose(unit.torque.noise, 0.5, rtol=0.1)
    np.testing.assert_allclose(unit.gyroscope.bias, plant.gyro_bias, atol=5.0 * 0.005 / np.sqrt(samples))
    assert unit.accelerometer.bias[2] == pytest.approx(plant.acc_bias[2], abs=0.01)
    assert unit.accelerometer.basis == "along gravity"
    assert unit.friction is None and "friction: not agreed to, left out" in result.notes
    assert "legs sink" in asked[0] and "MOVES" in asked[1]

    again = HungRobot(deployment)
    again.robot = CalibratedRobot(again.robot, unit)
    again.settle()
    left, _ = measure_hung(again.rest(SHORT.seconds), deployment, NOBODY, MADE)
    np.testing.assert_allclose(left.torque.offset, 0.0, atol=7.0 * 0.5 / np.sqrt(samples))
    np.testing.assert_allclose(left.gyroscope.bias, 0.0, atol=7.0 * 0.005 / np.sqrt(samples))
    assert abs(left.accelerometer.bias[2]) < 0.01


def test_with_a_yes_every_joint_is_swung_and_its_friction_found():
    limits = replace(SHORT, seconds=2.0, swing_s=4.0)
    ask, _ = answers(True, True)
    friction = calibrate_hung(hung(limits, torque_noise=0.1), NOBODY, 1, DATE, ask).unit.friction
    np.testing.assert_allclose(friction.coulomb, ROBOT.per_joint("friction"), atol=0.05)
    np.testing.assert_allclose(friction.viscous, ROBOT.per_joint("damping"), atol=0.1)
    assert max(friction.coulomb_std) < 0.02 and max(friction.viscous_std) < 0.05


def test_in_several_attitudes_the_accelerometer_is_told_whole(off_sensors):
    turns = iter([(0.6, 0, 0), (-0.6, 0, 0), (0, 0.6, 0), (0, -0.6, 0)])

    def tilt(question):
        """Turn the hoist as the operator would turn the robot."""
        if question.startswith("Attitude"):
            robot = off_sensors[-1]
            quat = np.empty(4)
            axis = np.array(next(turns))
            mujoco.mju_axisAngle2Quat(quat, axis / np.linalg.norm(axis), np.linalg.norm(axis))
            robot.data.qpos[3:7], robot.data.qvel[:6] = quat, 0.0
            # The weld holds the world in the trunk: data are anchor, position, attitude, and how stiff it turns.
            inverse, p = np.empty(4), np.empty(3)
            mujoco.mju_negQuat(inverse, quat)
            mujoco.mju_rotVecQuat(p, -robot.data.qpos[:3], inverse)
            robot.model.eq_data[0, 3:10] = [*p, *inverse]
        return "MOVES" not in question

    deployment = hung()
    unit = calibrate_hung(deployment, NOBODY, 5, DATE, tilt).unit
    np.testing.assert_allclose(unit.accelerometer.bias, draw_plant(ROBOT, deployment.hw).acc_bias, atol=0.015)
    assert unit.accelerometer.basis == "attitudes"


def test_through_the_real_robots_driver_it_keeps_the_drivers_pace_and_tells_temperatures():
    link = Wire(latency_s=0.0, jitter_s=0.0)
    wire = Aliengo(tick_unit="none", law_timeout_s=1.0, stale_s=1.0, **PATIENT)
    asked = Deployment(
        run=Run(clock="monotonic"),
        hw=Hw(backend="aliengo", start="hung", aliengo=wire),
        emulator=Emulator(pace="packets", commands=link, states=link),
    )
    with emulator(asked) as emulation:
        robot = HungRobot(emulation.deployment)
        try:
            samples = robot.rest(1.0)
            assert samples.temperature == pytest.approx(25.0, abs=1.0)
        finally:
            robot.close()
    assert (np.diff(samples.t) > 0.0).all() and 0.5 < samples.seconds < 1.5
    np.testing.assert_array_equal(samples.foot_force, 0.0)


def test_nothing_is_done_without_a_yes(monkeypatch):
    monkeypatch.setitem(io_module.BACKENDS, "mujoco", pytest.fail)
    with pytest.raises(CannotCalibrate, match="not agreed to: nothing was done"):
        calibrate_hung(hung(), NOBODY, 1, DATE, lambda question: False)


def test_a_robot_that_lies_does_not_hang():
    with pytest.raises(CannotCalibrate, match=r"below its hip = .* m, at least 0\.25: the robot lies"):
        calibrate_hung(hung(start="lying"), NOBODY, 1, DATE, lambda question: True)


def test_a_joint_that_is_held_back_ends_the_motion_and_the_robot_damps(monkeypatch):
    robots = []

    def blocked(deployment):
        robots.append(MujocoRobot(deployment))
        robots[0].model.dof_frictionloss[6] = 60.0  # FL_hip
        return robots[0]

    monkeypatch.setitem(io_module.BACKENDS, "mujoco", blocked)
    with pytest.raises(
        CannotCalibrate, match=r"FL_hip is 0\.1\d rad from where it should be, at most 0\.15: damped"
    ):
        calibrate_hung(hung(replace(SHORT, seconds=1.0)), NOBODY, 1, DATE, lambda question: True)
    assert not robots[0]._law.kp.any() and (robots[0]._law.kd == Hw().damping_kd).all()


@pytest.mark.parametrize(
    ("buttons", "words", "kd"),
    [(Button.L2 | Button.B, "damped", Hw().damping_kd), (HANDS_CLOSED, "no torque", 0.0)],
)
def test_the_remote_ends_it_in_the_cycle_in_which_it_is_read(monkeypatch, buttons, words, kd):
    laws, remote = [], StopChords(Aliengo().chords)

    class WithRemote(MujocoRobot):
        def read(self):
            held = Remote(buttons if self.t > 0.5 else Button(0))
            return replace(super().read(), stop=remote.held(held))

        def write(self, law, steps_later=0):
            laws.append(law)
            super().write(law, steps_later)

    monkeypatch.setitem(io_module.BACKENDS, "mujoco", WithRemote)
    robot = HungRobot(hung())
    with pytest.raises(CannotCalibrate, match=f"stopped at the remote: {words}"):
        robot.take_posture(np.tile(ROBOT.nominal.stand_q, 4))
    assert laws[-2].kp.any()  # it was on its way
    assert not laws[-1].kp.any() and not laws[-1].tau.any() and (laws[-1].kd == kd).all()


def measured(states, deployment, unit=NOBODY, level_floor=True):
    samples = samples_of([state.t for state in states], states)
    return measure_standing(samples, deployment, unit, level_floor, MADE)


def test_standing_on_a_level_floor_both_biases_are_found():
    deployment = Deployment(hw=Hw(seed=6), calibration=SHORT)
    states = standing_states(Io(deployment), 4.0)
    result, plant = measured(states, deployment), draw_plant(ROBOT, deployment.hw)
    np.testing.assert_allclose(result.unit.gyroscope.bias, plant.gyro_bias, atol=1e-3)
    np.testing.assert_allclose(result.unit.accelerometer.bias, plant.acc_bias, atol=0.02)
    assert result.unit.torque is None and any("hang it up" in note for note in result.notes)
    blind = measured(states, deployment, level_floor=False).unit.accelerometer
    assert blind.bias[2] == pytest.approx(plant.acc_bias[2], abs=0.01) and blind.basis == "along gravity"


def test_the_feet_of_an_emulated_robot_are_scaled_by_its_weight():
    link = Wire(latency_s=0.0, jitter_s=0.0)
    wire = Aliengo(exchange="cycle", tick_unit="none", **PATIENT)
    asked = Deployment(
        hw=Hw(backend="aliengo", seed=6, aliengo=wire),
        emulator=Emulator(pace="packets", commands=link, states=link),
        calibration=SHORT,
    )
    with emulator(asked) as emulation:
        io = Io(emulation.deployment)
        try:
            states = standing_states(io, 4.0)
        finally:
            io.robot.close()
    zero = Unit("aliengo", foot_zero=FootZero(MADE, (0.0,) * 4))
    scale = measured(states, asked, zero).unit.foot_scale
    np.testing.assert_allclose(scale.force, 1.0, atol=0.12)  # the plant's mass and balance are not the model's
    without = measured(states, asked)
    assert without.unit.foot_scale is None and any("zero is not known" in note for note in without.notes)


@pytest.fixture(scope="module")
def at_rest():
    """What a robot tells that stands still."""
    return standing_states(Io(Deployment(calibration=SHORT)), 0.5)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"omega_WB_B": np.array([0.0, 0.0, 0.2])}, r"the gyroscope's mean = 0\.2 rad/s, at most 0\.05: wait"),
        ({"acc_B": np.array([2.0, 0.0, 9.6])}, r"tilt = 0\.20\d rad, at most 0\.1: put the robot on level ground"),
        ({"acc_B": np.array([0.0, 0.0, 11.0])}, r"norm less gravity = 1\.19 m/s\^2, at most 0\.5"),
        ({"tau": np.zeros(12)}, "force on .* N, at least 20: let it stand on four feet"),
    ],
)
def test_what_is_not_a_robot_at_rest_on_its_feet_is_refused(at_rest, change, words):
    states = [replace(state, **change) for state in at_rest]
    with pytest.raises(CannotCalibrate, match=words):
        measured(states, Deployment(calibration=SHORT))


def test_a_joint_that_drifts_is_refused(at_rest):
    way = np.linspace(0.0, 0.05, len(at_rest))
    drifting = [replace(state, q=state.q + each) for state, each in zip(at_rest, way, strict=True)]
    with pytest.raises(CannotCalibrate, match=r"drift of .* = 0\.0\d+ rad, at most 0\.01: wait"):
        measured(drifting, Deployment(calibration=SHORT))
