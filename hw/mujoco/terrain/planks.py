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
from surefoot.hw.mujoco.terrain.section import Draw, Place, Section

_BEAM = (0.35, 0.25, 0.15, 1.0)
_BOARDS = ((0.80, 0.65, 0.45, 1.0), (0.72, 0.57, 0.38, 1.0))
_INCLINED_BEAM_M = 0.06  # a beam as high as the frame would lean under the next board

Boards = frozenset[tuple[int, int]]
"""Boards by row and column."""


def planks_section(terrain: Terrain, draw: Draw, incline: float = 0.0) -> Section:
    """Level planks, or on an incline [rad], above 0 uphill."""
    planks = terrain.planks
    length, width = _extent(planks)
    missing = _missing(planks, draw)
    ahead, up = length * cos(incline), length * sin(incline)

    def add(spec: mujoco.MjSpec, place: Place) -> None:
        _Frame(planks, place, incline, length, width).add(spec, missing)

    return Section(((0.0, 0.0), (ahead, up)), planks.frame_height_m - min(up, 0.0), add)


def _extent(planks: Planks) -> tuple[float, float]:
    """Length along travel and width [m]."""
    length = planks.rows * planks.pitch_m
    width = planks.columns * (planks.board_width_m + planks.gap_m)
    return (length, width) if planks.beam_direction == "across" else (width, length)


def _missing(planks: Planks, draw: Draw) -> Boards:
    """Boards that are not there.

    Those drawn leave a way across: no more than half of a row, and no two behind one another, so that whole
    boards lie before and behind each hole.
    """
    if not planks.missing_count:
        return frozenset(planks.missing)
    places = [(row, column) for row in range(planks.rows) for column in range(planks.columns)]
    while True:
        chosen: set[tuple[int, int]] = set()
        for index in draw("missing").permutation(len(places)):
            row, column = places[index]
            in_row = sum(other == row for other, _ in chosen)
            if in_row < planks.columns // 2 and not chosen & {(row - 1, column), (row + 1, column)}:
                chosen.add((row, column))
            if len(chosen) == planks.missing_count:
                return frozenset(chosen)


class _Frame:
    """The planks' own axes: x over the rows, which is travel (beams across) or sideways (beams along)."""

    def __init__(self, planks: Planks, place: Place, incline: float, length: float, width: float):
        self._planks, self._place, self._incline = planks, place, incline
        ahead = np.array([cos(incline), 0.0, sin(incline)])
        left = np.array([0.0, 1.0, 0.0])
        self._normal = np.array([-sin(incline), 0.0, cos(incline)])
        self._origin = np.array([place.x0, -0.5 * width, place.z0])
        if planks.beam_direction == "across":
            yaw, self._span = 0.0, width
        else:
            yaw, self._span = 0.5 * np.pi, length
            self._origin += length * ahead
        self._axis_x = cos(yaw) * ahead + sin(yaw) * left
        self._axis_y = cos(yaw) * left - sin(yaw) * ahead
        self._quat = np.zeros(4)
        lean = np.array([cos(0.5 * incline), 0.0, sin(-0.5 * incline), 0.0])
        mujoco.mju_mulQuat(self._quat, lean, np.array([cos(0.5 * yaw), 0.0, 0.0, sin(0.5 * yaw)]))

    def add(self, spec: mujoco.MjSpec, missing: Boards) -> None:
        planks = self._planks
        for row in range(planks.rows):
            x_beam = row * planks.pitch_m
            self._add_beam(spec, row, x_beam)
            for column in range(planks.columns):
                if (row, column) not in missing:
                    self._add_board(spec, row, column, x_beam + planks.beam_width_m)

    def _add_beam(self, spec: mujoco.MjSpec, row: int, x_beam: float) -> None:
        planks, place = self._planks, self._place
        height = _INCLINED_BEAM_M if self._incline else place.z0 - place.floor_z
        center = (
            self._origin + (x_beam + 0.5 * planks.beam_width_m) * self._axis_x + 0.5 * self._span * self._axis_y
        )
        spec.worldbody.add_geom(
            name=f"{place.prefix}beam_{row}",
            type=mujoco.mjtGeom.mjGEOM_BOX,
            size=[0.5 * planks.beam_width_m, 0.5 * self._span, 0.5 * height],
            pos=center - 0.5 * height * self._normal,
            quat=self._quat,
            rgba=_BEAM,
            **TERRAIN_BITS,
        )

    def _add_board(self, spec: mujoco.MjSpec, row: int, column: int, x_hinge: float) -> None:
        planks = self._planks
        y_board = column * (planks.board_width_m + planks.gap_m) + 0.5 * planks.board_width_m
        name = f"{self._place.prefix}board_{row}_{column}"
        hinge = self._origin + x_hinge * self._axis_x + y_board * self._axis_y
        board = spec.worldbody.add_body(name=name, pos=hinge, quat=self._quat)
        board.add_joint(
            name=name,
            type=mujoco.mjtJoint.mjJNT_HINGE,
            axis=[0.0, 1.0, 0.0],
            limited=mujoco.mjtLimited.mjLIMITED_TRUE,
            range=[0.0, planks.travel_limit],
            stiffness=[planks.stiffness * planks.board_length_m**2, 0.0, 0.0],
            springref=-atan2(planks.preload_n, planks.stiffness * planks.board_length_m),
            damping=[planks.damping * planks.board_length_m**2, 0.0, 0.0],
            solref_limit=[0.005, 1.0],
        )
        half_thickness = 0.5 * planks.board_thickness_m
        board.add_geom(
            name=name,
            type=mujoco.mjtGeom.mjGEOM_BOX,
            size=[0.5 * planks.board_length_m, 0.5 * planks.board_width_m, half_thickness],
            pos=[0.5 * planks.board_length_m, 0.0, -half_thickness],
            mass=planks.board_mass,
            rgba=_BOARDS[(row + column) % 2],
            **TERRAIN_BITS,
        )
