"""Whether the robot is at rest, and in the pose that was said."""

from __future__ import annotations

from math import acos

import numpy as np

from surefoot.config.calibration import Calibration
from surefoot.config.robot import GRAVITY, JOINT_NAMES, LEGS
from surefoot.tools.calibration.body_model import BodyModel
from surefoot.tools.calibration.refusal import CannotCalibrate, refuse_above, refuse_below
from surefoot.tools.calibration.samples import Samples


def check_rest(samples: Samples, limits: Calibration, drift_max: float) -> None:
    """Refuse a robot that moves; `drift_max`: how far a joint may [rad].

    Raises:
        CannotCalibrate: its trunk turns or shakes, a joint drifts, or the accelerometer's norm is not gravity's.
    """
    turn = float(np.abs(samples.omega_WB_B.mean(axis=0)).max())
    refuse_above("the gyroscope's mean", turn, limits.turn_max, "rad/s", "wait until the robot is at rest")
    moved = np.abs(samples.rate) * samples.seconds
    joint = int(np.argmax(moved))
    refuse_above(
        f"drift of {JOINT_NAMES[joint]}", moved[joint], drift_max, "rad", "wait until the robot is at rest"
    )
    shake = float(samples.acc_B.std(axis=0).max())
    refuse_above("the accelerometer's spread", shake, limits.shake_max, "m/s^2", "nobody may touch the robot")
    wrong = abs(float(np.linalg.norm(samples.acc_B.mean(axis=0))) - GRAVITY)
    refuse_above(
        "the accelerometer's norm less gravity",
        wrong,
        limits.gravity_error_max,
        "m/s^2",
        "the robot accelerates, or the sensor is broken; see hw.aliengo.reading.accelerometer",
    )


def check_standing(samples: Samples, force: np.ndarray, weight: float, limits: Calibration) -> float:
    """Refuse a robot that does not stand level and free on its four feet.

    Args:
        samples: at rest.
        force: (4,) vertical forces by eq. (7) [N].
        weight: of the robot [N].
        limits: of all that.

    Returns:
        How much of the weight the torques miss, or have too much.

    Raises:
        CannotCalibrate: it is tilted, a foot is light, or the torques do not add up to the weight.
    """
    tilt = acos(min(float(samples.up_B[2]), 1.0))
    refuse_above("tilt", tilt, limits.tilt_max, "rad", "put the robot on level ground and command stand")
    foot = int(np.argmin(force))
    refuse_below(
        f"force on {LEGS[foot]}", force[foot], limits.foot_min_n, "N", "let it stand on four feet: command stand"
    )
    share = abs(float(force.sum()) / weight - 1.0)
    refuse_above(
        "what the torques miss of the weight",
        share,
        limits.weight_error_max,
        "of it",
        "is it held, or loaded? else calibrate it hung up first, with the same --out: torque offsets",
    )
    return share


def check_hung(samples: Samples, model: BodyModel, limits: Calibration) -> None:
    """Refuse a damped robot that does not hang with its legs down.

    Damped motors carry nothing: what rests on its legs has folded them. So a long leg at rest hangs.

    Raises:
        CannotCalibrate: a leg is folded, or a motor that is to do nothing does something.
    """
    length = model.leg_lengths(samples.up_B, samples.q.mean(axis=0))
    leg = int(np.argmin(length))
    refuse_below(
        f"foot of {LEGS[leg]} below its hip",
        length[leg],
        limits.hung_leg_m,
        "m",
        "the robot lies, or a foot touches something: hang it up higher, all four legs down",
    )
    torque = np.abs(samples.tau.mean(axis=0))
    joint = int(np.argmax(torque))
    refuse_above(
        f"torque of {JOINT_NAMES[joint]}, damped",
        torque[joint],
        limits.hung_torque_max,
        "N m",
        "its motor or its sensor is broken",
    )


def check_feet(samples: Samples) -> np.ndarray:
    """(n, 4) raw figures of the foot sensors.

    Raises:
        CannotCalibrate: there are none.
    """
    if samples.foot_force is None:
        raise CannotCalibrate("this robot has no foot sensors, or io does not tell of them: left out")
    return samples.foot_force
