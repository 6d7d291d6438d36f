"""References for a robot that stands, for the tests of the optimal control problem."""

import numpy as np

from surefoot.components.ocp.node_reference import NodeReference
from surefoot.components.ocp.problem import State
from surefoot.components.robot_model import LegKinematics
from surefoot.config.robot import GRAVITY, load_robot

ROBOT = load_robot("aliengo")
LEGS = LegKinematics(ROBOT)
WEIGHT = ROBOT.mass * GRAVITY


def standing(N=67, dt=0.015, base=(0.0, 0.0, 0.4)):
    """(reference, measured state): four feet on flat ground, nothing asked but to stand."""
    q = np.tile(ROBOT.nominal.stand_q, 4).reshape(4, 3)
    p_WF = np.array(base) + LEGS.position(q)
    nodes = N + 1
    reference = NodeReference(
        t=dt * np.arange(nodes),
        dt=dt,
        contact=np.ones((nodes, 4), bool),
        p_WB=np.tile(base, (nodes, 1)),
        R_WB=np.tile(np.eye(3), (nodes, 1, 1)),
        q=np.tile(q, (nodes, 1, 1)),
        p_WF=np.tile(p_WF, (nodes, 1, 1)),
        v_WF=np.zeros((nodes, 4, 3)),
        force_W=np.tile([0.0, 0.0, WEIGHT / 4], (nodes, 4, 1)),
        force_max_n=np.full((nodes, 4), np.inf),
        normal_W=np.array([0.0, 0.0, 1.0]),
        support_leg=np.full(nodes, -1),
        support_margin_m=0.04,
        probe_leg=np.full(nodes, -1),
        probe_force_W=np.zeros((nodes, 3)),
        region_a=np.zeros((4, 4, 3)),
        region_b=np.zeros((4, 4)),
        region_active=np.zeros((nodes, 4), bool),
    )
    return reference, State(np.zeros(6), np.array(base), np.eye(3), q)
