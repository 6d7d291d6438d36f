"""Checks of what a robot at rest tells of itself."""

from __future__ import annotations

from collections.abc import Sequence
from math import acos

import numpy as np

from surefoot.config.doctor import Doctor
from surefoot.config.robot import GRAVITY, JOINT_NAMES, LEGS, Robot
from surefoot.hw.aliengo.aliengo_state import AliengoState
from surefoot.hw.aliengo.command_packet import BRAKE, SERVO
from surefoot.tools.doctor.check import Finding, Level, graded, well

_STOP_GIVES = 0.1  # [rad] a leg that lies is against its stop, and a stop is not quite where the table has it


def check_state(states: Sequence[AliengoState], remote: np.ndarray, robot: Robot, limits: Doctor) -> list[Finding]:
    """All findings of this group.

    Args:
        states: one or more, oldest first.
        remote: (40,) bytes of the remote.
        robot: its figures.
        limits: what is well.
    """
    acc = np.mean([state.acc_B for state in states], axis=0)
    omega = np.mean([state.omega_WB_B for state in states], axis=0)
    newest = states[-1]
    return [
        check_angles(newest.q, robot),
        check_accelerometer(acc, limits),
        check_level(acc, limits),
        check_gyroscope(omega, limits),
        check_temperature(newest.temperature, limits),
        check_modes(newest.mode),
        check_feet(np.array([state.foot_force for state in states])),
        check_remote(remote),
    ]


def check_angles(q: np.ndarray, robot: Robot) -> Finding:
    """Joint angles (12,) [rad] inside the ranges, but for the give of a stop."""
    check = "joint angles"
    low, high = np.array(robot.position_range()).T
    beyond = np.maximum(low - q, q - high)
    worst = int(np.argmax(beyond))
    expected = f"within {low[worst]:.2f} and {high[worst]:.2f} rad"
    if beyond[worst] <= _STOP_GIVES:
        return well(check, "all twelve inside their ranges")
    remedy = "its zero may be lost: switch the robot off, fold its legs as it lies, switch it on"
    return Finding(check, Level.FAIL, f"{JOINT_NAMES[worst]} at {q[worst]:.2f} rad", expected, remedy)


def check_accelerometer(acc_B: np.ndarray, limits: Doctor) -> Finding:
    """Mean specific force (3,) [m/s^2]: its length, and whether z reads +g at rest."""
    check, length = "accelerometer", float(np.linalg.norm(acc_B))
    found = f"{length:.2f} m/s^2, z {acc_B[2]:+.2f}"
    expected = f"{GRAVITY} +- {limits.gravity_error:g}, z upwards positive"
    if abs(length - GRAVITY) > limits.gravity_error:
        remedy = "let the robot rest; if it does, its IMU is not as this program reads it"
        return Finding(check, Level.FAIL, found, expected, remedy)
    if acc_B[2] < 0.0:
        remedy = "if the robot is upright, turn hw.aliengo.reading.accelerometer round ('up' or 'down')"
        return Finding(check, Level.FAIL, found, expected, remedy)
    return well(check, found, expected)


def check_level(acc_B: np.ndarray, limits: Doctor) -> Finding:
    """Mean specific force (3,) [m/s^2] along z, lying or standing."""
    tilt = tilt_of(acc_B)
    words = (
        f"tilted by {tilt:.2f} rad",
        f"within {limits.tilt_max:g} rad",
        "put it on level ground, or hang it up level",
    )
    return graded("level", tilt, (limits.tilt_max, limits.tilt_max), words)


def tilt_of(acc_B: np.ndarray) -> float:
    """Angle of the trunk's z from a specific force (3,) of a robot at rest [rad]; half a turn when it is zero."""
    length = float(np.linalg.norm(acc_B))
    return acos(max(-1.0, min(1.0, float(acc_B[2]) / length))) if length > 0.0 else acos(-1.0)


def check_gyroscope(omega_B: np.ndarray, limits: Doctor) -> Finding:
    """Mean angular velocity (3,) [rad/s] of a trunk that rests."""
    rate = float(np.linalg.norm(omega_B))
    remedy = "let it rest, and hang it up so that it does not swing"
    words = (f"{rate:.3f} rad/s", f"within {limits.still_rad_s:g} rad/s at rest", remedy)
    return graded("gyroscope", rate, (limits.still_rad_s, np.inf), words)


def check_temperature(motors: np.ndarray, limits: Doctor) -> Finding:
    """Of the motors (12,) [deg C]."""
    hottest = int(np.argmax(motors))
    words = (
        f"{JOINT_NAMES[hottest]} {motors[hottest]:.0f} deg C, the coldest {motors.min():.0f}",
        f"within {limits.motor_warm:g} deg C",
        f"let it cool down; it is not started above {limits.motor_hot:g}",
    )
    return graded("motors", float(motors[hottest]), (limits.motor_warm, limits.motor_hot), words)


def check_modes(modes: np.ndarray) -> Finding:
    """What the motors (12,) say that they do."""
    check, strange = "motor modes", [n for n, mode in enumerate(modes.tolist()) if mode not in (SERVO, BRAKE)]
    if not strange:
        return well(check, "all twelve follow")
    found = ", ".join(f"{JOINT_NAMES[n]} {int(modes[n]):02X}" for n in strange)
    remedy = "such a motor follows nothing, it may be too hot: switch the robot off and on once it is cool"
    return Finding(check, Level.FAIL, found, f"{SERVO:02X} (servo) or {BRAKE:02X} (brake)", remedy)


def check_feet(forces: np.ndarray) -> Finding:
    """Raw foot forces (n, 4) of a while: a sensor that tells exactly nothing is not there."""
    check, dead = "foot sensors", [leg for leg, force in zip(LEGS, forces.T, strict=True) if not force.any()]
    newest = " ".join(f"{force:.0f}" for force in forces[-1])
    if not dead:
        return well(check, f"{newest}, raw")
    remedy = "nothing depends on them: contact is told from the motors' torques"
    return Finding(check, Level.WARN, f"{', '.join(dead)} tell nothing", "four that speak", remedy)


def check_remote(data: np.ndarray) -> Finding:
    """The remote's (40,) bytes: of one that is off all are zero."""
    if data.any():
        return well("remote", "it is on")
    remedy = "switch it on: it is the only way to stop the robot without this machine"
    return Finding("remote", Level.WARN, "nothing comes from it", "on and in reach", remedy)
