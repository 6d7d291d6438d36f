"""Ground with known answers, and a robot that asks where to step on it."""

import numpy as np

from surefoot.bus.messages import FootholdRequest, Unsafe
from surefoot.components.elevation_map.foothold_adaptation import FootholdAdaptation
from surefoot.components.elevation_map.patch import Patch
from surefoot.components.robot_model import LegKinematics
from surefoot.components.robot_model.rotation import matrix_of_rpy
from surefoot.config.elevation_map import ElevationMap
from surefoot.config.fsm import Fsm
from surefoot.config.robot import load_robot

ROBOT = load_robot("aliengo")
CELL = ElevationMap().cell_m
RADIUS = ROBOT.foot.radius
NOMINAL_BF = LegKinematics(ROBOT).position(np.tile(ROBOT.nominal.stand_q, (4, 1)))
UP = np.array([0.0, 0.0, 1.0])
ADAPTATION = FootholdAdaptation(ROBOT, ElevationMap(), Fsm())


class Ground:
    """A map of cells centred on multiples of 2 cm, `half` of them to each side of the origin."""

    def __init__(self, height=lambda x, y: 0.0 * x, half=60):
        steps = CELL * np.arange(-half, half + 1)
        self.half = half
        self.x, self.y = np.meshgrid(steps, steps, indexing="ij")
        self.height = height(self.x, self.y)
        self.std = np.full(self.x.shape, 0.002)
        self.age = np.full(self.x.shape, 5.0)
        self.held = np.zeros(self.x.shape)
        self.collapsed = np.zeros(self.x.shape)

    def cell(self, x, y):
        """Index of the cell at x, y."""
        return round(x / CELL) + self.half, round(y / CELL) + self.half

    def cut(self, p_xy, half_x, half_y):
        """The patch around a point; NaN, and no load, beyond the map."""
        i, j = self.cell(*p_xy)
        size = 2 * self.half + 1
        rows, columns = np.arange(i - half_x, i + half_x + 1), np.arange(j - half_y, j + half_y + 1)
        inside = np.outer((rows >= 0) & (rows < size), (columns >= 0) & (columns < size))
        pick = np.ix_(np.clip(rows, 0, size - 1), np.clip(columns, 0, size - 1))
        seen = [np.where(inside, field[pick], np.nan) for field in (self.height, self.std, self.age)]
        loads = [np.where(inside, field[pick], 0.0) for field in (self.held, self.collapsed)]
        return Patch(CELL, CELL * np.array([rows[0] - self.half, columns[0] - self.half]), *seen, *loads)

    def ask(self, targets=None, feet=None, base=None, normal=UP, adaptation=ADAPTATION):
        """The answer to a robot that stands at the origin; what is left out is one step ahead on level ground."""
        stand = NOMINAL_BF + [0.0, 0.0, RADIUS - NOMINAL_BF[0, 2]]
        ahead = np.array([0.1, 0.0, 0.0])
        pose = np.array([0.1, 0.0, RADIUS - NOMINAL_BF[0, 2], 0.0, 0.0, 0.0])
        request = FootholdRequest(
            t=3.0,
            valid=True,
            id=7,
            target_WF=stand + ahead if targets is None else np.asarray(targets, float),
            p_WF=stand if feet is None else np.asarray(feet, float),
            base_target=pose if base is None else np.asarray(base, float),
            normal_W=normal,
        )
        return adaptation.regions(request, self.cut)


def standing_at(x, y, z=0.0, step=0.1):
    """Targets with the front left at (x, y) on ground of height z, feet a step behind them, and the base pose.

    The target is on a cell's centre if x and y are multiples of 2 cm.
    """
    targets = NOMINAL_BF - NOMINAL_BF[0] + [x, y, z + RADIUS]
    base = np.append(targets[0] - NOMINAL_BF[0], np.zeros(3))
    return {"targets": targets, "feet": targets - [step, 0.0, 0.0], "base": base}


def on_slope(slope, x=0.0, y=0.0):
    """The same on ground that rises with x by an angle [rad] through the origin, the base level with it."""
    normal = np.array([-np.sin(slope), 0.0, np.cos(slope)])
    pitch = matrix_of_rpy(np.array([0.0, -slope, 0.0]))
    turned = (NOMINAL_BF - NOMINAL_BF[0]) @ pitch.T
    first = np.array([x, y, np.tan(slope) * x + RADIUS / np.cos(slope)])
    targets = first + turned
    base = np.append(first - pitch @ NOMINAL_BF[0], [0.0, -slope, 0.0])
    return {"targets": targets, "feet": targets - 0.1 * pitch[:, 0], "base": base, "normal": normal}


def flagged(answer, reason, leg=0):
    """(15, 15) the cells of a leg's heightmap with a reason."""
    return (answer.heightmap_unsafe[leg] & reason) != 0


def rows(answer, reason, leg=0):
    """Indices along x of a leg's heightmap at which every cell has a reason; no row may have it in part."""
    cells = flagged(answer, reason, leg)
    assert (cells.all(axis=1) == cells.any(axis=1)).all(), cells.astype(int)
    return np.flatnonzero(cells.all(axis=1)).tolist()


def reasons(answer, leg=0):
    """Every reason that occurs in a leg's heightmap."""
    return Unsafe(int(np.bitwise_or.reduce(answer.heightmap_unsafe[leg], axis=None)))
