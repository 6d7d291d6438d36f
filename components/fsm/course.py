"""The way to go: which leg moves next, and where its foot is to stand."""

from __future__ import annotations

import numpy as np

from surefoot.components.fsm.foothold_planner import FootholdPlanner, plane_height
from surefoot.components.memory import Memory
from surefoot.config.fsm import Fsm

AROUND_POINTS = 4
"""Points probed around a foothold: front, back, left, right (Sec. II-D.5)."""


class Course:
    """A straight walk in one direction from where it was commanded, by the crawl's order of legs.

    Attributes:
        heading: yaw the robot keeps [rad].
        direction: (2,) unit vector of the walk in the world.
    """

    memory = Memory("heading", "direction", "_origin_W", "_place", "_first", _put_off=set)

    def __init__(self, planner: FootholdPlanner, settings: Fsm):
        self._planner, self._settings = planner, settings
        self.heading = 0.0
        self.direction = np.array([1.0, 0.0])
        self._origin_W = np.zeros((4, 3))
        self._place = 0
        self._first: list[int] = []
        self._put_off: set[int] = set()

    def begin(self, p_WF: np.ndarray, heading: float, direction_B: np.ndarray) -> None:
        """Start from feet (4, 3) in a direction (2,) of the base frame; no leg goes before the others."""
        self.heading = heading
        c, s = np.cos(heading), np.sin(heading)
        self.direction = np.array([[c, -s], [s, c]]) @ direction_B
        self._origin_W = p_WF.copy()
        self._place = 0
        self._first.clear()
        self._put_off.clear()

    def put_first(self, leg: int) -> None:
        """A leg without a foothold that can be trusted goes before all others, after those that wait already."""
        if leg not in self._first:
            self._first.append(leg)

    def settle(self, leg: int) -> None:
        """A leg has a foothold: it need not go first any more, and those that were put off may try again."""
        self._put_off.clear()
        if leg in self._first:
            self._first.remove(leg)

    def put_off(self, leg: int) -> None:
        """A leg has found no foothold: it waits until another one has moved, which changes what it can reach."""
        if leg in self._first:
            self._first.remove(leg)
        self._put_off.add(leg)

    def give_back(self, leg: int) -> None:
        """A leg that was to move has not left the ground: its turn comes again."""
        if leg not in self._first:
            self._place = self._settings.crawl_order.index(leg)

    def try_again(self) -> None:
        """The legs that were put off need not wait for another one to move; the first of them is next."""
        late = [leg for leg in self._settings.crawl_order if leg in self._put_off]
        self._put_off.clear()
        if late:
            self.give_back(late[0])

    @property
    def stuck(self) -> bool:
        """A leg has found no foothold and no other has moved since."""
        return bool(self._put_off)

    @property
    def waiting(self) -> tuple[int, ...]:
        """Legs that go first, in order."""
        return tuple(self._first)

    def next_leg(self, p_WF: np.ndarray, normal_W: np.ndarray) -> int:
        """The next leg of the crawl that has a step to make; -1 when there is none.

        No leg goes more than a step further than one that is put off: the stance must not be drawn apart.
        """
        if self._first:
            return self._first[0]
        settings = self._settings
        advance = (self.targets(p_WF, normal_W) - p_WF)[:, :2] @ self.direction
        done = (p_WF - self._origin_W)[:, :2] @ self.direction
        for turn in range(4):
            leg = settings.crawl_order[(self._place + turn) % 4]
            arrived = 0.0 < settings.goal_m <= done[leg]
            waits = leg in self._put_off or any(done[leg] > done[late] + settings.step_m for late in self._put_off)
            if not arrived and not waits and advance[leg] >= settings.step_min_m:
                self._place = (self._place + turn + 1) % 4
                return leg
        return -1

    def order_from(self, leg: int) -> np.ndarray:
        """(4,) legs in the order they move when `leg` is the first."""
        order = self._settings.crawl_order
        place = order.index(leg)
        return np.array([order[(place + turn) % 4] for turn in range(4)])

    def targets(self, p_WF: np.ndarray, normal_W: np.ndarray) -> np.ndarray:
        """(4, 3) reference footholds: nominal joints under the target base pose [m]."""
        return self._planner.targets(p_WF, self._target_xy(p_WF), self.heading, normal_W)

    def base_target(self, p_WF: np.ndarray, normal_W: np.ndarray) -> np.ndarray:
        """(6,) target base pose: a step ahead, adapted to the local plane (Sec. II-D.1)."""
        return self._planner.pose(self._target_xy(p_WF), p_WF, normal_W, self.heading)

    def candidates(self, target_W: np.ndarray, p_WF: np.ndarray, normal_W: np.ndarray) -> np.ndarray:
        """(n, 3) the target and the alternatives in front of it, on the local plane (Sec. II-D.3)."""
        settings = self._settings
        ahead = settings.alternative_spacing_m * np.arange(settings.alternatives + 1)
        points = np.tile(target_W, (len(ahead), 1))
        points[:, :2] += ahead[:, None] * self.direction
        points[:, 2] = plane_height(p_WF, normal_W, points[:, :2])
        return points

    def around(self, foothold_W: np.ndarray, number: int) -> np.ndarray:
        """(3,) point 1..4 around a foothold, or with 5 the foothold itself [m]."""
        along = np.append(self.direction, 0.0)
        left = np.array([-along[1], along[0], 0.0])
        offset = (along, -along, left, -left, 0.0 * along)[number - 1]
        return foothold_W + self._settings.around_radius_m * offset

    def _target_xy(self, p_WF: np.ndarray) -> np.ndarray:
        """Target base position: ahead of the feet's middle, on the line the walk began on."""
        start = self._planner.centre(self._origin_W, self.heading)
        done = (self._planner.centre(p_WF, self.heading) - start) @ self.direction
        return start + (done + self._settings.step_m) * self.direction
