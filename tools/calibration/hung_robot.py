"""A hung robot, moved and measured without any other process."""

from __future__ import annotations

from time import monotonic, sleep

import numpy as np

from surefoot.bus.messages import JointCommand
from surefoot.bus.topics import CYCLE_HZ
from surefoot.components.io.io import BACKENDS
from surefoot.config.deployment import Deployment
from surefoot.config.robot import JOINT_NAMES
from surefoot.hw.aliengo.deadlines import Deadlines
from surefoot.hw.aliengo.driver import AliengoDriver
from surefoot.hw.gate.gate import Gate
from surefoot.hw.robot_interface import MotorLaw, Sensors, Stop, damping_law
from surefoot.tools.calibration.joint_friction import swing
from surefoot.tools.calibration.refusal import CannotCalibrate
from surefoot.tools.calibration.samples import Samples, samples_of

_LOOK_S = 1.0  # a stretch in which resting joints are told from sinking ones


class HungRobot:
    """Damps unless it is told to move; every command that moves passes the gate.

    Moving goes by the gains of swing legs, wbc.joint_kp and joint_kd, from one reference to the next: a joint that
    is held back, or a trunk that swings, ends it and the robot damps. What is held on the robot's remote ends
    everything, in the cycle in which it is read: as with io a cut takes the torque, anything else damps.

    Attributes:
        robot: the robot interface in use.
    """

    def __init__(self, deployment: Deployment):
        """Open the robot, damping.

        Raises:
            HardwareFault: there is no way to it.
        """
        self._deployment, self._limits = deployment, deployment.calibration
        self._damp = damping_law(deployment.hw.damping_kd)
        self._gate = Gate(deployment.load_robot(), deployment.hw)
        self.robot = BACKENDS[deployment.hw.backend](deployment)
        self._waits = isinstance(self.robot, AliengoDriver)  # any other robot's time goes on by its cycles
        self._began, self._cycles = monotonic(), 0
        self._deadlines = Deadlines(1.0 / CYCLE_HZ, self._began)
        self._posture = np.zeros(12)
        self._told = self.robot.read()

    @property
    def t(self) -> float:
        """Time since the begin: the wall's for a robot that does not wait, else the cycles' [s]."""
        return monotonic() - self._began if self._waits else self._cycles / CYCLE_HZ

    def rest(self, seconds: float) -> Samples:
        """What it measures while it damps for so long.

        Raises:
            CannotCalibrate: somebody stopped it at the remote. So do all that move it.
        """
        begin, t, readings = self.t, [], []
        while self.t - begin < seconds:
            readings.append(self._cycle(self._damp))
            t.append(self._measured_t(readings[-1]))
        return samples_of(t, readings)

    def settle(self) -> None:
        """Damp until the joints rest, or `settle_s` are over."""
        begin, limits = self.t, self._limits
        still = 0.5 * limits.sink_max / limits.seconds
        while self.t - begin < limits.settle_s:
            if np.abs(self.rest(_LOOK_S).rate).max() < still:
                return

    def take_posture(self, posture: np.ndarray) -> None:
        """Go to a posture (12,) [rad] at `approach_speed`, gently at both ends.

        Raises:
            CannotCalibrate: something held it back.
        """
        start = self._cycle(self._damp).q
        way = posture - start
        seconds = max(float(np.abs(way).max()) * 0.5 * np.pi / self._limits.approach_speed, 1.0)
        begin = self.t
        while (s := (self.t - begin) / seconds) < 1.0:
            rate = 0.5 * np.pi / seconds * np.sin(np.pi * s)
            self._follow(start + 0.5 * (1.0 - np.cos(np.pi * s)) * way, rate * way)
        self._posture = posture

    def swing_joint(self, joint: int) -> Samples:
        """What it measures while one joint swings about the posture that was taken, the others held.

        Raises:
            CannotCalibrate: something held it back.
        """
        limits = self._limits
        begin, t, readings = self.t, [], []
        q, dq = self._posture.copy(), np.zeros(12)
        while (elapsed := self.t - begin) < limits.swing_s:
            x, dx = swing(elapsed, limits.swing_s, limits.swing_rad, limits.swing_hz)
            q[joint], dq[joint] = self._posture[joint] + x, dx
            readings.append(self._follow(q, dq))
            t.append(self._measured_t(readings[-1]))
        return samples_of(t, readings)

    def close(self) -> None:
        """Leave it damping."""
        self.robot.close()

    def _follow(self, q: np.ndarray, dq: np.ndarray) -> Sensors:
        """One cycle towards a reference."""
        wbc, t, told = self._deployment.wbc, self.t, self._told
        kp, kd = np.full(12, wbc.joint_kp), np.full(12, wbc.joint_kd)
        command = JointCommand(t=t, valid=True, q=q, dq=dq, kp=kp, kd=kd)
        law = self._gate.law(command, told, t, t - self._measured_t(told))
        if self._gate.damping:
            raise CannotCalibrate(f"the gate damps: {self._gate.reason}")
        self._watch(self._cycle(law), q)
        return self._told

    def _watch(self, told: Sensors, q: np.ndarray) -> None:
        off = np.abs(told.q - q)
        joint, limits = int(np.argmax(off)), self._limits
        turn = float(np.abs(told.omega_WB_B).max())
        if off[joint] > limits.tracking_max:
            raise CannotCalibrate(
                f"{JOINT_NAMES[joint]} is {off[joint]:.2f} rad from where it should be, at most "
                f"{limits.tracking_max:g}: damped; free the leg, or raise wbc.joint_kp"
            )
        if turn > limits.swing_turn_max:
            raise CannotCalibrate(
                f"the trunk turns at {turn:.2f} rad/s, at most {limits.swing_turn_max:g}: damped; hold it steadier"
            )

    def _measured_t(self, told: Sensors) -> float:
        """On the clock of `t`."""
        return self.t if told.t is None else told.t - self._began

    def _cycle(self, law: MotorLaw) -> Sensors:
        self.robot.write(law)
        self.robot.advance()
        self._cycles += 1
        if self._waits:
            deadline, _ = self._deadlines.following(monotonic())
            sleep(max(deadline - monotonic(), 0.0))
        self._told = self.robot.read()
        if self._told.stop:
            self._end(self._told.stop)
        return self._told

    def _end(self, stop: Stop) -> None:
        words = "damped"
        if stop == "cut":
            self._gate.cut("buttons of the remote")
            words = "no torque"
        self.robot.write(self._gate.safe_law)
        self.robot.advance()
        raise CannotCalibrate(f"stopped at the remote: {words}; begin again when nobody is in its way")
