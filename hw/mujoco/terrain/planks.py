"""Boards hinged on beams, a spring at each free end, on a frame above the ground (Sec. III-B.1).

A row is a rigid beam, flush with the surface, and a board hinged on its far edge. Pressed at distance d
from the hinge with a force F, a board of length L sinks by F d^2 / (k L^2) there: near the beam it bears,
towards its free end it gives way and a leg falls through.
"""

from __future__ import annotations

from math import atan2, cos, sin

import mujoco
import numpy as np

from surefoot.config.terrain import Planks, Terrain
from surefoot.hw.mujoco.robot_body import TERRAIN_BITS

_RIGID = (0.55, 0.58, 0.55, 1.0)
_BEAM = (0.35, 0.25, 0.15, 1.0)
_BOARDS = ((0.80, 0.65, 0.45, 1.0), (0.72, 0.57, 0.38, 1.0))
_PLATFORM_HALF_WIDTH_M = 1.0


def add_planks(spec: mujoco.MjSpec, terrain: Terrain, front_x: float) -> tuple[float, float]:
    """Add run-up, planks and run-out; returns start and end x of the planks [m]."""
    planks = terrain.planks
    length = planks.rows * planks.pitch_m
    width = planks.columns * (planks.board_width_m + planks.gap_m)
    if planks.beam_direction == "along":
        length, width = width, length
    start_x = front_x + planks.start_offset_m
    end_x = start_x + length
    spec.worldbody.add_geom(
        name="ground",
        type=mujoco.mjtGeom.mjGEOM_PLANE,
        size=[20.0, 20.0, 0.1],
        pos=[0.0, 0.0, -planks.frame_height_m],
        rgba=[0.4, 0.4, 0.42, 1.0],
        **TERRAIN_BITS,
    )
    _platform(spec, "run_up", start_x - planks.run_up_m, start_x, planks)
    _platform(spec, "run_out", end_x, end_x + planks.run_out_m, planks)
    _field(spec, planks, start_x, length, width)
    return start_x, end_x


def _platform(spec: mujoco.MjSpec, name: str, x0: float, x1: float, planks: Planks) -> None:
    height = planks.frame_height_m
    spec.worldbody.add_geom(
        name=name,
        type=mujoco.mjtGeom.mjGEOM_BOX,
        size=[0.5 * (x1 - x0), _PLATFORM_HALF_WIDTH_M, 0.5 * height],
        pos=[0.5 * (x0 + x1), 0.0, -0.5 * height],
        rgba=_RIGID,
        **TERRAIN_BITS,
    )


def _field(spec: mujoco.MjSpec, planks: Planks, start_x: float, length: float, width: float) -> None:
    """Rows advance along the field's own x axis, which is travel (beams across) or sideways (beams along)."""
    if planks.beam_direction == "across":
        origin, yaw, span = np.array([start_x, -0.5 * width, 0.0]), 0.0, width
    else:
        origin, yaw, span = np.array([start_x + length, -0.5 * width, 0.0]), 0.5 * np.pi, length
    axis_x, axis_y = np.array([cos(yaw), sin(yaw), 0.0]), np.array([-sin(yaw), cos(yaw), 0.0])
    quat = [cos(0.5 * yaw), 0.0, 0.0, sin(0.5 * yaw)]
    k_hinge = planks.stiffness * planks.board_length_m**2
    preload_angle = atan2(planks.preload_n, planks.stiffness * planks.board_length_m)
    half_thickness = 0.5 * planks.board_thickness_m
    for row in range(planks.rows):
        x_beam = row * planks.pitch_m
        beam_height = planks.frame_height_m
        center = origin + (x_beam + 0.5 * planks.beam_width_m) * axis_x + 0.5 * span * axis_y
        spec.worldbody.add_geom(
            name=f"beam_{row}",
            type=mujoco.mjtGeom.mjGEOM_BOX,
            size=[0.5 * planks.beam_width_m, 0.5 * span, 0.5 * beam_height],
            pos=center - [0.0, 0.0, 0.5 * beam_height],
            quat=quat,
            rgba=_BEAM,
            **TERRAIN_BITS,
        )
        for column in range(planks.columns):
            y_board = column * (planks.board_width_m + planks.gap_m) + 0.5 * planks.board_width_m
            hinge = origin + (x_beam + planks.beam_width_m) * axis_x + y_board * axis_y
            board = spec.worldbody.add_body(name=f"board_{row}_{column}", pos=hinge, quat=quat)
            board.add_joint(
                name=f"board_{row}_{column}",
                type=mujoco.mjtJoint.mjJNT_HINGE,
                axis=[0.0, 1.0, 0.0],
                limited=mujoco.mjtLimited.mjLIMITED_TRUE,
                range=[0.0, planks.travel_limit],
                stiffness=[k_hinge, 0.0, 0.0],
                springref=-preload_angle,
                damping=[planks.damping * planks.board_length_m**2, 0.0, 0.0],
                solref_limit=[0.005, 1.0],
            )
            board.add_geom(
                name=f"board_{row}_{column}",
                type=mujoco.mjtGeom.mjGEOM_BOX,
                size=[0.5 * planks.board_length_m, 0.5 * planks.board_width_m, half_thickness],
                pos=[0.5 * planks.board_length_m, 0.0, -half_thickness],
                mass=planks.board_mass,
                rgba=_BOARDS[(row + column) % 2],
                **TERRAIN_BITS,
            )
