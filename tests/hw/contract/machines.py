"""The robots that keep the contract: the simulated one, and the drivers with an emulator over real sockets."""

from contextlib import contextmanager
from time import monotonic, sleep

import mujoco
import numpy as np
from emulation import PATIENT, emulator

from surefoot.config.aliengo import Aliengo
from surefoot.config.deployment import Deployment, Run
from surefoot.config.emulator import Emulator, Wire
from surefoot.config.hw import Hw
from surefoot.config.robot import load_robot
from surefoot.hw.aliengo.backend import open_aliengo
from surefoot.hw.emulator.emulated_robot import CYCLE_S
from surefoot.hw.mujoco.backend import MujocoRobot
from surefoot.hw.robot_interface import damping_law

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


DAMPING_KD = 3.0

PATIENCE_S = 60.0
"""Until a test is given up; none depends on how soon something happens."""

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


class Held:
    """Holds the plant of an emulated robot fast, while its tick and its packets go on.

    A driver with a thread of its own sends when it likes. Here the plant moves for as many cycles as it is
    released for, each under the law that was asked for, however long a busy machine takes and whatever is sent
    meanwhile.

    Attributes:
        left: cycles that it has not made yet.
        tick: from which on the robot tells of what came of the last of them.
    """

    def __init__(self, robot):
        self._robot, self._law, self._fits = robot, None, False
        self.left = self.tick = 0
        self._write, self._advance = robot.plant.write, robot.plant.advance
        robot.plant.write, robot.plant.advance = self.write, self.advance

    def release(self, cycles, law):
        """Let it go on by so many cycles of a law."""
        self._law, self.left = law, cycles

    def write(self, law, steps_later=0):
        self._fits = self.left > 0 and same_but_for_rounding(law, self._law)
        if self._fits:
            self._write(law, steps_later)

    def advance(self):
        if self._fits:
            self._advance()
            self.tick = round(1e6 * (self._robot.t + CYCLE_S))
            self.left -= 1


def same_but_for_rounding(law, asked):
    """Whether a law is what came of another in a packet; an angle without a gain says nothing."""
    q = np.where(asked.kp > 0.0, asked.q, 0.0)
    places = (("dq", 1e-5), ("kp", 1 / 32), ("kd", 1 / 16), ("tau", 1 / 256))
    alike = all(np.allclose(getattr(law, name), getattr(asked, name), rtol=0, atol=atol) for name, atol in places)
    return alike and np.allclose(law.q, q, rtol=0, atol=1e-5)


class ByTimer(InLockstep):
    """The real robot's driver, whose thread sends a command in every cycle, with the same emulator."""

    def __init__(self, emulation):
        self._held = Held(emulation.robot)
        super().__init__(emulation)

    def run(self, cycles, law=None):
        self._held.release(cycles, damping_law(DAMPING_KD) if law is None else law)
        end = monotonic() + PATIENCE_S
        while self._held.left or self.robot.newest.state.tick < self._held.tick:
            assert monotonic() < end, "the robot was not asked for what it was to do"
            if law is not None:
                self.robot.write(law)
            self.robot.advance()
            sleep(0.001)
        return self.robot.read()

    def close(self):
        self.robot.close()
        while self._emulation.robot.commands <= self.robot.statistics.commands:  # until the last one is heard
            sleep(0.001)
        self._emulation.switch_off()

    def step_plant(self):
        self._held.release(1, damping_law(DAMPING_KD))
        super().step_plant()


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
