"""Why a robot is not to be moved now, from what is on the bus."""

from __future__ import annotations

from collections import deque

import numpy as np

from surefoot.bus.messages import HardwareState
from surefoot.bus.topics import TOPICS
from surefoot.config.doctor import Doctor
from surefoot.config.robot import JOINT_NAMES, Robot
from surefoot.tools.doctor.check import Level
from surefoot.tools.doctor.robot_state import check_angles, check_gyroscope, check_level
from surefoot.tools.picture import Picture

_READINGS = 10  # a robot that has just been put down trembles: the median of so many counts


class Readiness:
    """Judges one robot by the limits of `surefoot doctor`."""

    def __init__(self, robot: Robot, limits: Doctor):
        self._robot, self._limits = robot, limits
        self._lie_q = np.tile(robot.nominal.lie_q, 4)
        self._readings: deque[HardwareState] = deque(maxlen=_READINGS)

    def look(self, picture: Picture) -> None:
        """Take in what the robot's sensors tell now."""
        hardware = picture.hardware
        if hardware is not None and (not self._readings or self._readings[-1].t != hardware.t):
            self._readings.append(hardware)

    def awaited(self, picture: Picture) -> str:
        """In words whom the stack still waits for; empty when all have spoken and the robot is told of."""
        absent = [name for name, watched in picture.processes.items() if watched.status is None]
        if absent:
            return f"{', '.join(absent)} to come up"
        silent = {
            "hw/state": picture.hardware,
            "state/estimate": picture.estimate,
            "fsm/reference": picture.reference,
        }
        keys = [key for key, message in silent.items() if message is None]
        return f"{TOPICS[keys[0]].writer} to tell {keys[0]}" if keys else ""

    def refusal(self, picture: Picture, lies: bool) -> str:
        """Why it is not to be moved, with what to do; empty if it may be.

        Args:
            picture: of the run, looked at before.
            lies: it is said to lie folded on its belly, not to hang.
        """
        for name, watched in picture.processes.items():
            if watched.status is not None and watched.status.life == "FAILED":
                return f"{name} has failed: {watched.status.reason}"
        hardware = picture.hardware
        if hardware is None or self.awaited(picture):
            return f"it waits for {self.awaited(picture)}"
        if hardware.damping:
            return f"the gate in io damps: {hardware.gate}"
        return self._of_robot(hardware) or (self._folded(hardware) if lies else "")

    def _of_robot(self, hardware: HardwareState) -> str:
        """By what its sensors tell."""
        acc = np.median([each.acc_B for each in self._readings], axis=0)
        omega = np.median([each.omega_WB_B for each in self._readings], axis=0)
        for finding in (
            check_angles(hardware.q, self._robot),
            check_level(acc, self._limits),
            check_gyroscope(omega, self._limits),
        ):
            if finding.level in (Level.WARN, Level.FAIL):
                return f"{finding.check}: {finding.found}, expected {finding.expected}. {finding.remedy}"
        return ""

    def _folded(self, hardware: HardwareState) -> str:
        error = np.abs(hardware.q - self._lie_q)
        worst = int(np.argmax(error))
        if error[worst] <= self._limits.lie_error:
            return ""
        return (
            f"it does not lie folded: {JOINT_NAMES[worst]} is {error[worst]:.2f} rad from where it lies, limit "
            f"{self._limits.lie_error:g} rad (doctor.lie_error). Fold its legs, hips straight, calves closed"
        )
