"""Wall time of the plant: what simulating costs, beside what controlling costs."""

from __future__ import annotations

from array import array
from time import perf_counter

from surefoot.hw.mujoco.backend import MujocoRobot


class Stopwatch:
    """Times every `advance` of a robot from outside: the robot, and what it sends, know nothing of it.

    Attributes:
        step_ms: wall time of each cycle [ms].
    """

    def __init__(self, robot: MujocoRobot):
        self.step_ms = array("f")
        self._advance = robot.advance
        vars(robot)["advance"] = self  # an instance's own attribute goes before its class's method

    def __call__(self) -> None:
        begun = perf_counter()
        self._advance()
        self.step_ms.append(1e3 * (perf_counter() - begun))
