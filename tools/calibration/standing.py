"""What a robot that stands tells of itself."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from surefoot.config.deployment import Deployment
from surefoot.config.robot import GRAVITY
from surefoot.config.unit import Accelerometer, FootScale, Gyroscope, Measured, Unit
from surefoot.tools.calibration import inertial_sensors as imu
from surefoot.tools.calibration.body_model import BodyModel
from surefoot.tools.calibration.foot_force import foot_scale, shares_of_weight
from surefoot.tools.calibration.joint_torque import noise_under_control
from surefoot.tools.calibration.pose_checks import check_feet, check_rest, check_standing
from surefoot.tools.calibration.refusal import CannotCalibrate
from surefoot.tools.calibration.result import Result
from surefoot.tools.calibration.samples import Samples
from surefoot.tools.calibration.thresholds import propose


def measure_standing(
    samples: Samples, deployment: Deployment, unit: Unit, level_floor: bool, measured: Measured
) -> Result:
    """Biases of the IMU, and the foot sensors' scale.

    Not the torque offsets: statics of the trunk are six equations, for twelve offsets and twelve components of
    ground forces. They take a robot hung up.

    Args:
        samples: raw, as no robot file has corrected them.
        deployment: which robot, limits, present settings.
        unit: what is known of it: torque offsets and zeros of the feet.
        level_floor: the floor is known to be level; else the accelerometer's bias across gravity stays unknown.
        measured: when and how.

    Raises:
        CannotCalibrate: it moves, or does not stand as it should.
    """
    model, limits = BodyModel(deployment.load_robot()), deployment.calibration
    check_rest(samples, limits, limits.drift_max)
    q, up_B = samples.q.mean(axis=0), samples.up_B
    offset = np.array(unit.torque.offset if unit.torque else np.zeros(12))
    force = model.vertical_forces(up_B, q, samples.tau.mean(axis=0) - offset)
    share = check_standing(samples, force, model.weight, limits)
    p_BF, J_B = model.feet(q)
    acc_B = samples.acc_B.mean(axis=0)
    if level_floor:
        bias = imu.bias_on_level_floor(acc_B, imu.floor_normal(p_BF), GRAVITY)
    else:
        bias = imu.bias_along_gravity(acc_B, GRAVITY)
    known = replace(
        unit,
        gyroscope=Gyroscope(measured, tuple(imu.gyroscope_bias(samples.omega_WB_B).tolist())),
        accelerometer=Accelerometer(
            measured, tuple(bias.tolist()), "level floor" if level_floor else "along gravity"
        ),
    )
    noise = noise_under_control(samples.tau)
    friction = np.array(unit.friction.coulomb) if unit.friction else model.friction
    notes = [
        f"torques say that the feet bear {force.sum():.0f} N of {model.weight:.0f} N",
        f"torque noise under control, an upper limit: {noise.min():.3f} to {noise.max():.3f} N m",
        "torque offsets: not told by a standing robot, whose ground forces nobody knows; hang it up",
    ]
    try:
        bears = shares_of_weight(force, *model.level(up_B, q), model.weight)
        known = replace(known, foot_scale=_foot_scale(samples, unit, bears, measured, share))
    except CannotCalibrate as refused:
        notes.append(f"scale of the foot sensors: {refused}")
    return Result(known, tuple(notes), propose(deployment, J_B, up_B, noise, friction))


def _foot_scale(samples: Samples, unit: Unit, force: np.ndarray, measured: Measured, share: float) -> FootScale:
    raw = check_feet(samples)
    if unit.foot_zero is None:
        raise CannotCalibrate("their zero is not known: calibrate the robot hung up first, with the same --out")
    scale = foot_scale(raw, np.array(unit.foot_zero.raw), force)
    return FootScale(measured, tuple(scale.tolist()), share)
