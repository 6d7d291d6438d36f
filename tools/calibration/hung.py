"""What a robot that hangs tells of itself."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Literal

import numpy as np

from surefoot.config.deployment import Deployment
from surefoot.config.robot import GRAVITY, JOINT_NAMES
from surefoot.config.unit import Accelerometer, FootZero, Friction, Gyroscope, Measured, Torque, Unit
from surefoot.tools.calibration import inertial_sensors as imu
from surefoot.tools.calibration.body_model import BodyModel
from surefoot.tools.calibration.foot_force import foot_zero
from surefoot.tools.calibration.hung_robot import HungRobot
from surefoot.tools.calibration.joint_friction import FrictionFit, fit_friction
from surefoot.tools.calibration.joint_torque import noise_at_rest, offset_at_rest
from surefoot.tools.calibration.pose_checks import check_hung, check_rest
from surefoot.tools.calibration.refusal import CannotCalibrate
from surefoot.tools.calibration.result import Result
from surefoot.tools.calibration.samples import Samples
from surefoot.tools.calibration.thresholds import Proposal, propose

Ask = Callable[[str], bool]
"""Puts a question to the operator; whether the answer was yes."""

_UP = np.array([0.0, 0.0, 1.0])
_SMOOTH_S = 0.1  # a twentieth of a swing; the noise of what inertia asks is then far below the torques' own


def calibrate_hung(deployment: Deployment, unit: Unit, attitudes: int, date: str, ask: Ask) -> Result:
    """Damp, measure, and with the operator's yes swing each joint.

    Args:
        deployment: which robot; no stack may run.
        unit: what is known of it; what is measured takes its place.
        attitudes: in how many the accelerometer is read; 1 leaves its bias across gravity unknown.
        date: of the measurement.
        ask: the operator.

    Raises:
        CannotCalibrate: the operator did not agree, or the robot does not hang at rest.
        HardwareFault: there is no way to it.
    """
    if not ask("The robot hangs, its four feet free, and nobody is near: it will be damped, and its legs sink."):
        raise CannotCalibrate("not agreed to: nothing was done")
    hung = HungRobot(deployment)
    try:
        hung.settle()
        samples = hung.rest(deployment.calibration.seconds)
        measured = Measured(date, "hung", samples.seconds, samples.temperature)
        known, notes = measure_hung(samples, deployment, unit, measured)
        if attitudes > 1:
            known = replace(
                known, accelerometer=_in_attitudes(hung, deployment, samples, attitudes, measured, ask)
            )
        if ask(_motion(deployment)):
            fits = swing_joints(hung, deployment, samples.up_B, range(12))
            known = replace(known, friction=_friction(fits, measured, deployment))
            notes += (_centre(fits, _offset(samples, deployment)),)
        else:
            notes += ("friction: not agreed to, left out",)
    finally:
        hung.close()
    return Result(known, notes, _proposals(deployment, known, samples))


def measure_hung(
    samples: Samples, deployment: Deployment, unit: Unit, measured: Measured
) -> tuple[Unit, tuple[str, ...]]:
    """What a damped robot at rest tells: IMU, torque offset and noise, zeros of the feet.

    Raises:
        CannotCalibrate: it moves, or does not hang.
    """
    check_rest(samples, deployment.calibration, deployment.calibration.sink_max)
    check_hung(samples, BodyModel(deployment.load_robot()), deployment.calibration)
    acc_B = imu.bias_along_gravity(samples.acc_B.mean(axis=0), GRAVITY)
    offset, noise = _offset(samples, deployment), noise_at_rest(samples.tau)
    known = replace(
        unit,
        gyroscope=Gyroscope(measured, tuple(imu.gyroscope_bias(samples.omega_WB_B).tolist())),
        accelerometer=Accelerometer(measured, tuple(acc_B.tolist()), "along gravity"),
        torque=Torque(measured, tuple(offset.tolist()), tuple(noise.tolist())),
    )
    if samples.foot_force is None:
        return known, ("zero of the foot sensors: this robot has none, left out",)
    zero = FootZero(measured, tuple(foot_zero(samples.foot_force).tolist()))
    return replace(known, foot_zero=zero), ()


def swing_joints(
    hung: HungRobot, deployment: Deployment, up_B: np.ndarray, joints: Sequence[int]
) -> list[FrictionFit]:
    """Take the stand posture and swing joints in it, one after the other.

    Args:
        hung: damped.
        deployment: which robot, and how far and fast.
        up_B: (3,) against gravity in the trunk.
        joints: numbers of those to swing.

    Raises:
        CannotCalibrate: something held a joint back, or it hardly moved.
    """
    robot, settings = deployment.load_robot(), deployment.calibration
    model = BodyModel(robot)
    hung.take_posture(np.tile(robot.nominal.stand_q, 4))
    swung = [hung.swing_joint(joint) for joint in joints]  # fitted afterwards: a held robot waits for nothing
    fits = []
    for joint, samples in zip(joints, swung, strict=True):
        rows = zip(samples.q, samples.dq, samples.acceleration(_SMOOTH_S), strict=True)
        model_tau = np.array([model.torques(up_B, *row)[joint] for row in rows])
        try:
            fit = fit_friction(samples.tau[:, joint], samples.dq[:, joint], model_tau, settings.slow_speed)
        except CannotCalibrate as refused:
            raise CannotCalibrate(f"{JOINT_NAMES[joint]}: {refused}") from None
        fits.append(fit)
    return fits


def _in_attitudes(
    hung: HungRobot, deployment: Deployment, first: Samples, count: int, measured: Measured, ask: Ask
) -> Accelerometer:
    settings = deployment.calibration
    means = [first.acc_B.mean(axis=0)]
    while len(means) < count:
        if not ask(f"Attitude {len(means) + 1} of {count}: tilt the trunk another way, and let it come to rest."):
            raise CannotCalibrate(f"ended after {len(means)} of {count} attitudes")
        hung.settle()
        samples = hung.rest(settings.seconds)
        check_rest(samples, settings, settings.sink_max)
        means.append(samples.acc_B.mean(axis=0))
    bias, _ = imu.bias_of_attitudes(np.array(means), GRAVITY, settings.attitude_spread)
    return Accelerometer(measured, tuple(bias.tolist()), "attitudes")


def _motion(deployment: Deployment) -> str:
    settings = deployment.calibration
    return (
        f"Now it MOVES: all legs to the stand posture, then each joint for {settings.swing_s:g} s by up to "
        f"{settings.swing_rad:g} rad, {12 * settings.swing_s / 60.0:.1f} min in all. Ctrl-C damps."
    )


def _friction(fits: Sequence[FrictionFit], measured: Measured, deployment: Deployment) -> Friction:
    figures: dict[Literal["coulomb", "viscous", "coulomb_std", "viscous_std"], tuple] = {
        "coulomb": tuple(fit.coulomb for fit in fits),
        "viscous": tuple(fit.viscous for fit in fits),
        "coulomb_std": tuple(fit.coulomb_std for fit in fits),
        "viscous_std": tuple(fit.viscous_std for fit in fits),
    }
    return Friction(replace(measured, seconds=12.0 * deployment.calibration.swing_s), **figures)


def _centre(fits: Sequence[FrictionFit], offset: np.ndarray) -> str:
    """The other measure of the offset, that both directions of motion have in common."""
    off = np.abs(np.array([fit.centre for fit in fits]) - offset)
    joint = int(np.argmax(off))
    return (
        f"offsets at rest and in motion differ by up to {off[joint]:.2f} N m ({JOINT_NAMES[joint]}): so wrong are "
        "the model's gravity torques"
    )


def _offset(samples: Samples, deployment: Deployment) -> np.ndarray:
    return offset_at_rest(samples.tau, samples.rate, deployment.hw.damping_kd)


def _proposals(deployment: Deployment, unit: Unit, samples: Samples) -> tuple[Proposal, ...]:
    """For a foot under the robot as it stands."""
    robot = deployment.load_robot()
    model = BodyModel(robot)
    _, J_B = model.feet(np.tile(robot.nominal.stand_q, 4))
    coulomb = np.array(unit.friction.coulomb) if unit.friction else model.friction
    return propose(deployment, J_B, _UP, noise_at_rest(samples.tau), coulomb)
