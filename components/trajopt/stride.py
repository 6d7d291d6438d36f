"""The references of one stride: four swings in turn, the base on a straight line (Sec. II-B.3)."""

from __future__ import annotations

import numpy as np

from surefoot.bus.messages import MotionReference, PlanRequest
from surefoot.components.gait.swing_spline import SwingSpline
from surefoot.components.ocp.certified_load import load_limit
from surefoot.components.ocp.foot_placement import LANDING_SHARE
from surefoot.components.ocp.node_reference import NodeReference
from surefoot.components.robot_model import LegKinematics
from surefoot.components.robot_model.rotation import pose_change
from surefoot.components.robot_model.rotations import matrices_of_rpy
from surefoot.config.fsm import Fsm
from surefoot.config.robot import GRAVITY, Robot
from surefoot.config.trajopt import Trajopt


class Stride:
    """Samples a stride on the problem's nodes; its swings have the shape of those that are carried out."""

    def __init__(self, robot: Robot, settings: Trajopt, stepping: Fsm):
        self._legs = LegKinematics(robot)
        self._weight = robot.mass * GRAVITY
        self._settings, self._stepping = settings, stepping
        self.t = settings.interval_s * np.arange(settings.intervals + 1)

    def touch_down(self, place: int) -> float:
        """Time at which the leg that moves as number `place` (0..3) lands, from the stride's start [s]."""
        return (place + 1) * (self._settings.shift_s + self._settings.swing_s)

    def sample(self, request: PlanRequest, base_now: np.ndarray) -> NodeReference:
        """References from the present base pose (6,) to the request's target."""
        settings, stepping, t = self._settings, self._stepping, self.t
        nodes = len(t)
        contact = np.ones((nodes, 4), bool)
        p_WF, v_WF = np.tile(request.p_WF, (nodes, 1, 1)), np.zeros((nodes, 4, 3))
        region_active = np.zeros((nodes, 4), bool)
        certified_n = np.tile(request.force_max_n, (nodes, 1))
        for place, leg in enumerate(request.leg_order):
            landing = self.touch_down(place)
            lifted = request.lifted and place == 0
            swing = MotionReference(
                swing_from=request.p_WF[leg],
                swing_to=request.target_WF[leg],
                swing_t0=0.0 if lifted else landing - settings.swing_s,
                swing_t1=landing,
                swing_height=stepping.swing_height_m,
                swing_v_lift=stepping.swing_v_lift,
                swing_v_touch=stepping.swing_v_touch,
                normal_W=request.normal_W,
            )
            # Half a nanosecond: node times are multiples of the interval only to rounding.
            in_air = (t > swing.swing_t0 - 5e-10) & (t < landing - 5e-10)
            after = t > landing - 5e-10
            contact[in_air, leg] = False
            p_WF[in_air, leg], v_WF[in_air, leg], _ = SwingSpline(swing).sample(t[in_air])
            p_WF[after, leg] = request.target_WF[leg]
            lands = t > landing - LANDING_SHARE * settings.swing_s - 5e-10
            certified_n[after, leg] = 0.0  # nobody has tried the new foothold yet
            region_active[lands, leg] = request.region_active[leg]
        share = (t / t[-1])[:, None]
        pose = base_now + share * pose_change(base_now, request.base_target)
        R_WB = matrices_of_rpy(pose[:, 3:])
        force_W = np.zeros((nodes, 4, 3))
        force_W[..., 2] = contact * (self._weight / contact.sum(axis=1))[:, None]
        off = np.full(nodes, -1)
        return NodeReference(
            t=t,
            dt=settings.interval_s,
            contact=contact,
            p_WB=pose[:, :3],
            R_WB=R_WB,
            q=self._legs.inverse((p_WF - pose[:, None, :3]) @ R_WB)[0],
            p_WF=p_WF,
            v_WF=v_WF,
            force_W=force_W,
            force_max_n=load_limit(certified_n),
            normal_W=request.normal_W,
            support_leg=off,
            support_margin_m=0.0,
            probe_leg=off,
            probe_force_W=np.zeros((nodes, 3)),
            region_a=request.region_a,
            region_b=request.region_b,
            region_active=region_active,
        )
