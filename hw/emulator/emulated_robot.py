"""The Aliengo of the emulator: packets in, packets out, MuJoCo's robot between them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import asin, atan2

import numpy as np

from surefoot.bus.messages import SimTruth
from surefoot.bus.topics import CYCLE_HZ
from surefoot.config.deployment import Deployment
from surefoot.hw.aliengo.aliengo_state import AliengoState
from surefoot.hw.aliengo.command_packet import decode_command
from surefoot.hw.aliengo.generation import GENERATIONS
from surefoot.hw.aliengo.plausibility import Plausibility
from surefoot.hw.aliengo.remote import Button, Remote, buttons_of
from surefoot.hw.aliengo.state_packet import encode_state
from surefoot.hw.aliengo.tick_clock import UNITS_S
from surefoot.hw.emulator.broken_parts import BrokenParts
from surefoot.hw.emulator.motors import Motors
from surefoot.hw.emulator.witness import Witness
from surefoot.hw.errors import PacketError
from surefoot.hw.mujoco.backend import STEPS_PER_CYCLE, MujocoRobot
from surefoot.hw.mujoco.scene import PHYSICS_DT

CYCLE_S = 1.0 / CYCLE_HZ
"""By which the robot's time goes on at once [s]."""


class EmulatedRobot:
    """Physics, delays and noise are the simulated robot's, limits and meanings those of `hw.aliengo`.

    Attitude and foot forces in its packets are the simulator's truth: no driver passes on the one, no controller
    reads the other.

    Attributes:
        plant: the simulated robot behind it.
        witness: of what truly becomes of it.
        commands: how many it has followed.
        refused: how many it has not, for they were damaged or no commands.
        trouble: in words what was last amiss with one.
    """

    def __init__(self, deployment: Deployment):
        robot, wire, settings = deployment.load_robot(), deployment.hw.aliengo, deployment.emulator
        self.plant = MujocoRobot(deployment)
        self._generation, self._reading = GENERATIONS[wire.generation], wire.reading
        self._plausibility = Plausibility(robot, wire.plausible)
        self._settings = settings
        self._broken = BrokenParts(settings.faults)
        self._motors = Motors(robot, settings.motors, self._broken)
        self._cycle_ticks = round(CYCLE_S / UNITS_S[settings.tick_unit])
        self._cycles = 0
        self.commands = self.refused = 0
        self.trouble = ""
        self.witness = Witness(self.plant.field.end_x + robot.foot.radius)
        self._state = self._measured(self.plant.truth())

    @property
    def t(self) -> float:
        """The robot's time [s]."""
        return self._cycles * CYCLE_S

    def take(self, packet: bytes) -> bool:
        """Follow a command from now on; whether it is one."""
        try:
            command = decode_command(packet, self._generation, self._plausibility)
        except PacketError as error:
            self.refused += 1
            self.trouble = str(error)
            return False
        self._motors.command(command, self.t)
        self.commands += 1
        return True

    def answer(self) -> bytes | None:
        """The packet of the present state; None from a robot that has fallen silent."""
        if self._broken.has("silent", self.t):
            return None
        return encode_state(self._state, self._generation, self._reading)[0]

    def advance(self, arrive: Callable[[float], None] = lambda t: None) -> None:
        """Go on by a cycle.

        Args:
            arrive: called with the time of each physics step [s], to take the commands that have come by then;
                the motors follow them from that step on.

        Raises:
            HardwareFault: the physics diverged.
        """
        self.plant.push(self._broken.push(self.t))
        for step in range(STEPS_PER_CYCLE):
            t = self.t + step * PHYSICS_DT
            arrive(t)
            law = self._motors.law(t)
            self.plant.write(law, step)
        self.plant.advance()
        truth = self.plant.truth()
        self._cycles += 1
        self._motors.warm(truth.tau, CYCLE_S, self.t)
        self.witness.see(truth, law, self.t)
        self._state = self._with_stuck_parts(self._measured(truth))

    def _measured(self, truth: SimTruth) -> AliengoState:
        sensors = self.plant.read()
        return AliengoState(
            quat_WB=truth.quat_WB,
            omega_WB_B=sensors.omega_WB_B,
            acc_B=sensors.acc_B,
            rpy=_roll_pitch_yaw(truth.quat_WB),
            imu_temperature=self._settings.motors.ambient,
            mode=self._motors.mode,
            q=sensors.q,
            dq=sensors.dq,
            ddq=np.zeros(12),
            tau=sensors.tau,
            temperature=self._motors.temperature,
            foot_force=truth.force_W[:, 2],  # in newtons, as good a unit as any
            tick=(self._settings.tick_start + self._cycles * self._cycle_ticks) % 2**32,
            remote=Remote(self._held()),
        )

    def _held(self) -> Button:
        """What somebody holds on the remote now."""
        presses = [press for press in self._settings.presses if press.begin_s <= self.t < press.end_s]
        return buttons_of(name for press in presses for name in press.buttons)

    def _with_stuck_parts(self, state: AliengoState) -> AliengoState:
        """What is stuck tells what it told a cycle ago."""
        last, broken, t = self._state, self._broken, self.t
        stuck = broken.joints("stuck encoder", t)
        state = replace(state, q=np.where(stuck, last.q, state.q), dq=np.where(stuck, last.dq, state.dq))
        if broken.has("stuck imu", t):
            imu = ("quat_WB", "omega_WB_B", "acc_B", "rpy")
            state = replace(state, **{name: getattr(last, name) for name in imu})
        return replace(state, tick=last.tick) if broken.has("stuck tick", t) else state


def _roll_pitch_yaw(quat: np.ndarray) -> np.ndarray:
    """(3,) angles [rad] of a quaternion (w, x, y, z), turned about z, then y, then x."""
    w, x, y, z = quat.tolist()
    return np.array(
        [
            atan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y)),
            asin(min(max(2.0 * (w * y - z * x), -1.0), 1.0)),
            atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z)),
        ]
    )
