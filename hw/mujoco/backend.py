"""The simulated robot: 1 kHz physics and motor law, command delay, sensor noise, truth for grading."""

from __future__ import annotations

from collections import deque

import mujoco
import numpy as np

from surefoot.bus.messages import SimTruth
from surefoot.bus.topics import CYCLE_HZ
from surefoot.config.deployment import Deployment
from surefoot.config.robot import LEGS
from surefoot.hw.errors import HardwareFault
from surefoot.hw.mujoco.depth_camera import DepthCamera
from surefoot.hw.mujoco.hoist import HOIST_M, hang
from surefoot.hw.mujoco.plant import draw_plant, stream
from surefoot.hw.mujoco.scene import PHYSICS_DT, build_scene
from surefoot.hw.robot_interface import DepthImage, MotorLaw, Sensors, damping_law

STEPS_PER_CYCLE = round(1.0 / (CYCLE_HZ * PHYSICS_DT))
"""Physics steps in one cycle of the interface."""

_SETTLE_S = 2.0
_HOLD_KP, _HOLD_KD = 300.0, 8.0  # [N m/rad], [N m s/rad]: stiff enough to sag by millimetres only


class MujocoRobot:
    """A robot in MuJoCo behind the robot interface.

    Physics is split (`mj_step2`, then `mj_step1`), so that between cycles every position and velocity
    belongs to the present instant; accelerations and contact forces are those of the step just made.
    """

    def __init__(self, deployment: Deployment):
        robot = deployment.load_robot()
        settings = deployment.hw
        plant = draw_plant(robot, settings)
        hoist = hang if settings.start == "hung" else None
        self.model, self.field = build_scene(deployment, plant.robot, plant.friction, hoist)
        self.data = mujoco.MjData(self.model)
        self._plant, self._settings = plant, settings
        self._torque_limit = np.array(robot.per_joint("torque_limit"))
        self._noise = {name: stream(settings.seed, name) for name in ("q", "dq", "tau", "gyro", "acc")}
        self._camera = DepthCamera(settings.depth, self.model, settings.seed) if deployment.run.vision else None
        self._images = 0
        self._damp = damping_law(settings.damping_kd)
        self._laws: deque[tuple[int, MotorLaw]] = deque()
        self._law = self._damp
        self._delay_steps = round(settings.command_delay_s / PHYSICS_DT)
        self._step = 0
        self._written = False
        self._tau = np.zeros(12)
        self._name_parts()
        self._truth_forces = np.zeros((4, 3))
        self._body_contact = ""
        self._saturated = False
        self._spawn(robot, settings.start)
        self._settle()

    @property
    def t(self) -> float:
        """Simulated time [s]."""
        return self._step * PHYSICS_DT

    @property
    def trouble(self) -> str:
        """Empty: there is no link, and every law fits."""
        return ""

    def read(self) -> Sensors:
        data, settings = self.data, self._settings
        if not np.isfinite(data.qpos).all():
            raise HardwareFault(
                f"the simulation diverged at {self.t:.3f} s, positions are not finite: lower the gains, or give "
                "softer contacts (hw.solref_s)"
            )
        noise = {
            name: rng.standard_normal(12 if name in ("q", "dq", "tau") else 3) for name, rng in self._noise.items()
        }
        return Sensors(
            q=data.qpos[7:19] + settings.encoder_noise * noise["q"],
            dq=data.qvel[6:18] + settings.velocity_noise * noise["dq"],
            tau=self._tau + settings.torque_noise * noise["tau"],
            omega_WB_B=data.sensordata[3:6] + self._plant.gyro_bias + settings.gyro_noise * noise["gyro"],
            acc_B=data.sensordata[0:3] + self._plant.acc_bias + settings.acc_noise * noise["acc"],
        )

    def depth(self) -> DepthImage | None:
        """An image in the first cycle at or after each of its instants; those that were missed are left out."""
        due = int(self.t * self._settings.depth.rate_hz + 1e-9) + 1
        if self._camera is None or due <= self._images:
            return None
        self._images = due
        return self._camera.image(self.data)

    def write(self, law: MotorLaw, steps_later: int = 0) -> None:
        """The motor law of this cycle, or from so many physics steps after its beginning on."""
        self._laws.append((self._step + self._delay_steps + steps_later, law))
        self._written = True

    def advance(self) -> None:
        if not self._written:
            self.write(self._damp)
        self._written = False
        for index in range(STEPS_PER_CYCLE):
            while self._laws and self._laws[0][0] <= self._step:
                self._law = self._laws.popleft()[1]
            self._apply(self._law)
            mujoco.mj_step2(self.model, self.data)
            if index == STEPS_PER_CYCLE - 1:
                self._note_contacts()
            mujoco.mj_step1(self.model, self.data)
            self._step += 1

    def push(self, wrench_W: np.ndarray) -> None:
        """From outside onto the trunk until the next call: (6,) force [N] and moment [N m] in the world."""
        self.data.xfrc_applied[self._trunk_body] = wrench_W

    def close(self) -> None:
        self._laws.clear()
        self._law = self._damp

    def truth(self) -> SimTruth:
        """The simulator's own state at the present instant, for grading only."""
        data = self.data
        return SimTruth(
            t=self.t,
            valid=True,
            p_WB=data.qpos[:3].copy(),
            quat_WB=data.qpos[3:7].copy(),
            v_WB_W=data.qvel[:3].copy(),
            omega_WB_B=data.qvel[3:6].copy(),
            q=data.qpos[7:19].copy(),
            dq=data.qvel[6:18].copy(),
            tau=self._tau.copy(),
            com_W=data.subtree_com[self._trunk_body].copy(),
            p_WF=data.geom_xpos[self._foot_geoms].copy(),
            force_W=self._truth_forces.copy(),
            body_contact=self._body_contact,
            saturated=self._saturated,
            power_w=float(np.abs(self._tau * data.qvel[6:18]).sum()),
            terrain_q=data.qpos[19:].copy(),
        )

    def _apply(self, law: MotorLaw) -> None:
        """The motor law on the true joint state, inside the motors' limits."""
        q, dq = self.data.qpos[7:19], self.data.qvel[6:18]
        asked = law.tau + law.kp * (law.q - q) + law.kd * (law.dq - dq)
        np.clip(asked, -self._torque_limit, self._torque_limit, out=self._tau)
        self._saturated = bool((asked != self._tau).any())
        self.data.qfrc_applied[6:18] = self._tau

    def _name_parts(self) -> None:
        model = self.model
        self._trunk_body = model.body("trunk").id
        self._foot_geoms = np.array([model.geom(f"{leg}_foot").id for leg in LEGS])
        self._foot_of_geom = np.full(model.ngeom, -1)
        self._foot_of_geom[self._foot_geoms] = np.arange(4)
        self._robot_geom = model.geom_contype == 1
        self._geom_names = [model.geom(index).name for index in range(model.ngeom)]

    def _note_contacts(self) -> None:
        """Force on each foot in the world, and which other parts touch, from the step just made."""
        data = self.data
        forces = self._truth_forces
        forces[:] = 0.0
        touching: list[str] = []
        contact = data.contact
        geoms = contact.geom
        if len(geoms):
            # Elliptic cones: a contact's rows of efc_force are its force along the contact frame's axes.
            address, frames = contact.efc_address, contact.frame
            # Stones touch each other and the ground too; sleeping ones make no contacts among themselves.
            for index in np.flatnonzero(self._robot_geom[geoms].any(axis=1)):
                if address[index] < 0:
                    continue
                first, second = geoms[index]
                # The frame's first axis points from the first geom to the second, and acts on the second.
                mine, sign = (second, 1.0) if self._robot_geom[second] else (first, -1.0)
                foot = self._foot_of_geom[mine]
                if foot >= 0:
                    local = data.efc_force[address[index] : address[index] + 3]
                    forces[foot] += sign * (local @ frames[index].reshape(3, 3))
                else:
                    touching.append(self._geom_names[mine])
        self._body_contact = " ".join(sorted(set(touching))) if touching else ""

    def _spawn(self, robot, start: str) -> None:
        """Put the robot at x = y = 0, its feet (or belly) on the surface z = 0, or hung above it."""
        posture = robot.nominal.lie_q if start == "lying" else robot.nominal.stand_q
        data = self.data
        data.qpos[:7] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]
        data.qpos[7:19] = np.tile(posture, 4)
        mujoco.mj_kinematics(self.model, data)
        lowest = data.geom_xpos[self._foot_geoms, 2].min() - robot.foot.radius
        belly = -0.5 * robot.collision["trunk"].size[2]
        data.qpos[2] = HOIST_M if start == "hung" else -min(lowest, belly)
        mujoco.mj_forward(self.model, data)

    def _settle(self) -> None:
        """Hold the posture until it rests: a run starts with a robot that stands or lies still."""
        one = np.ones(12)
        hold = MotorLaw(
            q=self.data.qpos[7:19].copy(), dq=0 * one, kp=_HOLD_KP * one, kd=_HOLD_KD * one, tau=0 * one
        )
        for _ in range(round(_SETTLE_S / PHYSICS_DT)):
            self._apply(hold)
            mujoco.mj_step2(self.model, self.data)
            mujoco.mj_step1(self.model, self.data)
        self.data.qpos[:2] = 0.0
        self.data.time = 0.0
        mujoco.mj_step1(self.model, self.data)
