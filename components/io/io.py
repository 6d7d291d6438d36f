"""The robot's sensors onto the bus, the gated command to its motors, at 500 Hz."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from surefoot.bus.messages import DepthFrame, HardwareState
from surefoot.bus.topics import CYCLE_HZ
from surefoot.components.component import Component, Inbox, Outbox
from surefoot.components.io.operator_hand import OperatorHand
from surefoot.config.deployment import Deployment
from surefoot.hw.aliengo.backend import open_aliengo
from surefoot.hw.calibrated_robot import CalibratedRobot
from surefoot.hw.gate.gate import Gate
from surefoot.hw.mujoco.backend import MujocoRobot
from surefoot.hw.robot_interface import MotorLaw, RobotInterface, Sensors

BACKENDS = {"mujoco": MujocoRobot, "aliengo": open_aliengo}
"""The robot interface behind each name of `hw.backend`."""

_NO_FEET = np.zeros(0)


class Io(Component):
    """Reads, publishes, gates and writes, then lets the plant advance to the next cycle.

    Every command passes the gate in the cycle in which it is applied; a missing, stale or malformed one
    makes that same cycle damp, and so does a robot that is beyond its limits. In a dry run the motors only damp,
    and the gate tells what it would let pass.

    Attributes:
        robot: the robot interface in use.
    """

    name: ClassVar[str] = "io"
    inputs: ClassVar[tuple[str, ...]] = ("joint/command", "operator/command")
    outputs: ClassVar[tuple[str, ...]] = ("hw/state", "hw/depth", "sim/truth")
    remembers: ClassVar[bool] = False

    def __init__(self, deployment: Deployment):
        super().__init__(deployment)
        unit = deployment.load_unit()
        robot: RobotInterface = BACKENDS[deployment.hw.backend](deployment)
        self.robot = robot if unit is None else CalibratedRobot(robot, unit)
        self._gate = Gate(deployment.load_robot(), deployment.hw)
        self._hand = OperatorHand(self._gate, deployment.operator.settle_s)
        self.said = self._hand.said
        self._dry = deployment.hw.dry_run
        self._began: float | None = None
        self._cycles = 0

    def step(self, t: float, inbox: Inbox, outbox: Outbox) -> None:
        sensors = self.robot.read()
        measured_t = t - sensors.age_s if sensors.t is None else sensors.t - self.deployment.run.epoch_s
        law, damping, reason = self._judged(inbox, sensors, t, t - measured_t)
        if self._gate.measured:  # else there is nothing that may be published; the gate has said what is wrong
            outbox.publish(
                "hw/state",
                HardwareState(
                    t=measured_t,
                    valid=True,
                    q=sensors.q,
                    dq=sensors.dq,
                    tau=sensors.tau,
                    omega_WB_B=sensors.omega_WB_B,
                    acc_B=sensors.acc_B,
                    damping=damping,
                    gate=reason,
                    foot_force=_NO_FEET if sensors.foot_force is None else sensors.foot_force,
                ),
            )
        image = self.robot.depth()
        if image is not None:
            outbox.publish(
                "hw/depth",
                DepthFrame(
                    t=t,
                    valid=True,
                    p_BC=image.p_BC,
                    quat_BC=image.quat_BC,
                    fov=image.fov,
                    depth_m=image.depth_m,
                ),
            )
        truth = self.robot.truth()
        if truth is not None:
            outbox.publish("sim/truth", truth)
        self._advance(t, law)
        self.trouble = "; ".join(words for words in (reason, self.robot.trouble) if words)

    def deactivate(self, t: float, inbox: Inbox, outbox: Outbox) -> bool:
        """The last command damps, or leaves the torque cut; then the robot is let go."""
        self.robot.write(self._gate.safe_law)
        self.robot.advance()
        self.robot.close()
        return True

    def _judged(self, inbox: Inbox, sensors: Sensors, t: float, age_s: float) -> tuple[MotorLaw, bool, str]:
        """What the motors get, whether that damps, and what is to be said of it; people are heard first."""
        command = inbox.latest("joint/command")
        self._hand.feel(sensors.stop)
        for message in inbox.new("operator/command"):
            self._hand.hear(message, t)
        self._hand.watch(command, t)
        law = self._gate.law(command, sensors, t, age_s)
        if not self._dry:
            return law, self._gate.damping, self._gate.reason
        words = self._gate.reason or "the command would pass"
        return self._gate.safe_law, True, f"DRY RUN, the motors only damp: {words}"

    def _advance(self, t: float, law: MotorLaw) -> None:
        """One cycle; on the monotonic clock those that were missed too: a simulated plant does not wait.

        The gate has judged the command's age at the last of them: in none is it older.
        """
        if self._began is None:
            self._began = t
        due = round((t - self._began) * CYCLE_HZ) + 1
        for _ in range(max(due - self._cycles, 0)):
            self.robot.write(law)
            self.robot.advance()
            self._cycles += 1
