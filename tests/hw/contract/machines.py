"""The robots that keep the contract: the simulated one, and the drivers with an emulator over real sockets."""

from contextlib import contextmanager
from time import sleep

import mujoco
import numpy as np
from emulation import PATIENT, emulator

from surefoot.config.aliengo import Aliengo
from surefoot.config.deployment import Deployment, Run
from surefoot.config.emulator import Emulator, Wire
from surefoot.config.hw import Hw
from surefoot.config.robot import load_robot
from surefoot.hw.aliengo.backend import open_aliengo
from surefoot.hw.mujoco.backend import MujocoRobot

NOISES = ("torque_noise", "encoder_noise", "velocity_noise", "gyro_noise", "gyro_bias", "acc_noise", "acc_bias")
SOUND = Wire(latency_s=0.0, jitter_s=0.0)


def deployment(exchange="timer", commands=SOUND, states=SOUND, faults=(), **wire):
    """A robot on its belly, without noise or delay, on a link in no hurry."""
    link = PATIENT | {"law_timeout_s": 1.0, "stale_s": 1.0, "tick_unit": "none"} | wire
    clock = {"timer": "monotonic", "cycle": "simulated"}[exchange]
    return Deployment(
        run=Run(clock=clock),
        hw=Hw(
            backend="aliengo",
            start="lying",
            command_delay_s=0.0,
            aliengo=Aliengo(exchange=exchange, **link),
            **dict.fromkeys(NOISES, 0.0),
        ),
        emulator=Emulator(pace="packets", commands=commands, states=states, faults=faults),
    )


CYCLE_US = 2000

LEGS_UP = np.tile([0.0, 2.8, -1.5], 4)
"""On its belly, nothing but the trunk touches the ground."""


def raise_legs(plant):
    """Put a lying robot into another posture at once."""
    belly_m = 0.5 * load_robot("aliengo").collision["trunk"].size[2]
    plant.data.qpos[:19] = [0.0, 0.0, belly_m, 1.0, 0.0, 0.0, 0.0, *LEGS_UP]
    plant.data.qvel[:] = 0.0
    mujoco.mj_step1(plant.model, plant.data)


class Simulated:
    """MuJoCo's robot.

    Attributes:
        robot: behind the robot interface.
        plant: the simulator, for what it alone knows.
    """

    def __init__(self):
        self.robot = self.plant = MujocoRobot(deployment())
        raise_legs(self.plant)

    def run(self, cycles, law=None):
        """The reading after so many cycles with a law, or without one."""
        for _ in range(cycles):
            if law is not None:
                self.robot.write(law)
            self.robot.advance()
        return self.robot.read()

    def close(self):
        """Let go of it; then the plant can be stepped by hand."""
        self.robot.close()

    def step_plant(self):
        self.plant.advance()

    def break_down(self):
        """No more readings are to be had."""
        self.plant.data.qpos[:] = np.nan


class InLockstep(Simulated):
    """The driver that waits, with an emulator paced by packets."""

    def __init__(self, emulation):
        self._emulation = emulation
        self.robot, self.plant = open_aliengo(emulation.deployment), emulation.robot.plant

    def close(self):
        self.robot.close()
        self._emulation.switch_off()

    def step_plant(self):
        self._emulation.robot.advance()

    def break_down(self):
        self._emulation.switch_off()


class ByTimer(InLockstep):
    """The real robot's driver, whose thread sends a command in every cycle, with the same emulator."""

    def close(self):
        self.robot.close()
        while self._emulation.robot.commands <= self.robot.statistics.commands:  # until the last one is heard
            sleep(0.001)
        self._emulation.switch_off()

    def run(self, cycles, law=None):
        """The same at the least: as many commands after those that are on their way, which each take a cycle."""
        until = self.robot.statistics.commands + 1 + cycles
        while self.robot.newest.state.tick < CYCLE_US * until:
            if law is not None:
                self.robot.write(law)
            self.robot.advance()
            sleep(0.001)
        return self.robot.read()


@contextmanager
def machine(kind, **wire):
    """One of `KINDS`, for the time of a test; `wire`: settings of its link."""
    if kind == "mujoco":
        yield Simulated()
        return
    driver, exchange, generation = KINDS[kind]
    with emulator(deployment(exchange, generation=generation, **wire), raise_legs) as emulation:
        made = driver(emulation)
        try:
            yield made
        finally:
            made.robot.close()


KINDS = {
    "mujoco": None,
    "lockstep, G0": (InLockstep, "cycle", "G0"),
    "lockstep, G1": (InLockstep, "cycle", "G1"),
    "timer, G1": (ByTimer, "timer", "G1"),
}

IN_STEP = [kind for kind in KINDS if not kind.startswith("timer")]
"""Those whose cycles are the caller's."""
