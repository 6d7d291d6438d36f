"""The state machine's motion reference, sampled at the problem's nodes (Sec. II-B.3)."""

from __future__ import annotations

import numpy as np

from surefoot.bus.messages import MotionReference
from surefoot.components.gait.swing_spline import SwingSpline
from surefoot.components.ocp.certified_load import load_limit
from surefoot.components.ocp.foot_placement import LANDING_SHARE
from surefoot.components.ocp.node_reference import NodeReference
from surefoot.components.robot_model import LegKinematics
from surefoot.components.robot_model.rotation import pose_change
from surefoot.components.robot_model.rotations import matrices_of_rpy
from surefoot.config.robot import GRAVITY, Robot


class MotionSampler:
    """Makes a `NodeReference` over N intervals of `dt` from what the state machine asks.

    Attributes:
        legs: the robot's leg kinematics.
    """

    def __init__(self, robot: Robot, N: int, dt: float):
        self.legs = LegKinematics(robot)
        self._weight = robot.mass * GRAVITY
        self._offsets = dt * np.arange(N + 1)
        self._dt = dt

    def sample(self, reference: MotionReference, t: float) -> NodeReference:
        """The references at t, t + dt, ..., t + N dt."""
        times = t + self._offsets
        nodes = len(times)
        contact = np.ones((nodes, 4), bool)
        p_WF, v_WF = np.empty((nodes, 4, 3)), np.zeros((nodes, 4, 3))
        p_WF[:] = reference.p_WF
        leg = reference.swing_leg
        if leg >= 0:
            self._swing(reference, times, leg, contact, p_WF, v_WF)
        p_WB, R_WB = self._base(reference, times)
        p_BF = (p_WF - p_WB[:, None]) @ R_WB
        force_W = np.zeros((nodes, 4, 3))
        force_W[..., 2] = contact * (self._weight / contact.sum(axis=1))[:, None]
        supported = (times >= reference.support_t0) & (times < reference.support_t1)
        probe_leg, probe_force_W = self._probe(reference, times, contact)
        region_a, region_b, region_active = self._region(reference, times)
        return NodeReference(
            t=times,
            dt=self._dt,
            contact=contact,
            p_WB=p_WB,
            R_WB=R_WB,
            q=self.legs.inverse(p_BF)[0],
            p_WF=p_WF,
            v_WF=v_WF,
            force_W=force_W,
            force_max_n=np.tile(load_limit(reference.force_max_n), (nodes, 1)),
            normal_W=reference.normal_W,
            support_leg=np.where(supported, reference.support_leg, -1),
            support_margin_m=reference.support_margin_m,
            probe_leg=probe_leg,
            probe_force_W=probe_force_W,
            region_a=region_a,
            region_b=region_b,
            region_active=region_active,
        )

    @staticmethod
    def _swing(reference, times, leg, contact, p_WF, v_WF) -> None:
        """From lift-off on the leg carries nothing: a landing is not counted on until it is felt.

        A plan that expects the foot's help in the next moment tips the base towards it, and goes on tipping
        for as long as the ground is late.
        """
        in_air = times >= reference.swing_t0
        contact[in_air, leg] = False
        landed = in_air & (times >= reference.swing_t1) & reference.swing_lands
        flying = in_air & ~landed
        if flying.any():
            p_WF[flying, leg], v_WF[flying, leg], _ = SwingSpline(reference).sample(times[flying])
        p_WF[landed, leg] = reference.swing_to

    @staticmethod
    def _region(reference: MotionReference, times: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Eq. (4) of a swing leg: from the last part of its swing on, until the state machine has seen it land."""
        active = np.zeros((len(times), 4), bool)
        leg = reference.swing_leg
        if leg < 0 or not reference.region_active:
            return _NO_REGION_A, _NO_REGION_B, active
        a, b = _NO_REGION_A.copy(), _NO_REGION_B.copy()
        a[leg], b[leg] = reference.region_a, reference.region_b
        last_s = LANDING_SHARE * (reference.swing_t1 - reference.swing_t0)
        active[:, leg] = times >= reference.swing_t1 - last_s
        return a, b, active

    @staticmethod
    def _base(reference: MotionReference, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Linear interpolation between two poses, as the paper has it; a heading turns the nearer way."""
        duration = max(reference.base_t1 - reference.base_t0, 1e-6)
        share = _unit((times - reference.base_t0) / duration)[:, None]
        pose = reference.base_from + share * pose_change(reference.base_from, reference.base_to)
        return pose[:, :3], matrices_of_rpy(pose[:, 3:])

    @staticmethod
    def _probe(
        reference: MotionReference, times: np.ndarray, contact: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Eq. (6): each force for its dwell, reached by a linear blend from the one before it."""
        nodes = len(times)
        forces = reference.probe_force_W
        if reference.probe_leg < 0 or len(forces) < 2:
            return np.full(nodes, -1), np.zeros((nodes, 3))
        dwell = max(reference.probe_dwell_s, 1e-6)
        since = times - reference.probe_t0
        index = np.floor(since / dwell).astype(int)
        active = (index >= 0) & (index < len(forces) - 1) & contact[:, reference.probe_leg]
        index = np.minimum(np.maximum(index, 0), len(forces) - 2)
        blend = _unit((since - index * dwell) / max(reference.probe_blend_s, 1e-6))[:, None]
        before = forces[index]
        force = before + blend * (forces[index + 1] - before)
        return np.where(active, reference.probe_leg, -1), force


def _unit(share: np.ndarray) -> np.ndarray:
    """Clipped to [0, 1]; `np.clip` costs three times as much at this length."""
    return np.minimum(np.maximum(share, 0.0), 1.0)


_NO_REGION_A, _NO_REGION_B = np.zeros((4, 4, 3)), np.zeros((4, 4))
