"""The elevation map's process: images and verdicts in, safe regions out. Blind, the whole plane is allowed."""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np

from surefoot.bus.codec import decode, encode
from surefoot.bus.messages import FootholdRegions, FootholdRequest, StateEstimate
from surefoot.bus.topics import TOPICS
from surefoot.components.component import Component, Inbox, Outbox
from surefoot.components.elevation_map.depth_points import refusal
from surefoot.components.elevation_map.foothold_adaptation import FootholdAdaptation
from surefoot.components.elevation_map.pose_match import PoseMatch
from surefoot.components.elevation_map.terrain_map import TerrainMap
from surefoot.config.deployment import Deployment

_BASE_SPEED = 2.0
"""The trunk is never faster [m/s]."""


class ElevationMap(Component):
    """Keeps the map and answers every foothold request (SEND of Fig. 6).

    Sec. II-B.5: when no map is available, the safe region defaults to the entire plane and the adapted
    footholds are the targets themselves.

    Attributes:
        map: what is known of the ground.
    """

    name: ClassVar[str] = "elevation_map"
    inputs: ClassVar[tuple[str, ...]] = (
        "hw/depth",
        "state/estimate",
        "fsm/reference",
        "fsm/event",
        "foothold/request",
    )
    outputs: ClassVar[tuple[str, ...]] = ("foothold/regions", "map/elevation")

    def __init__(self, deployment: Deployment):
        super().__init__(deployment)
        self._vision = deployment.run.vision
        # In simulated time a restarted estimator takes up where its predecessor was: its frame is the same.
        self._new_boot_new_frame = deployment.run.clock == "monotonic"
        if self._vision:
            self.complete = ("state/estimate",)  # an image needs the very one of its time
        self._settings = deployment.elevation_map
        robot = deployment.load_robot()
        self.map = TerrainMap(self._settings, robot.foot.radius)
        self._adaptation = FootholdAdaptation(robot, self._settings, deployment.fsm)
        self._match = PoseMatch()
        self._last: StateEstimate | None = None
        self._refused = ""
        self._publish_t = 0.0

    def step(self, t: float, inbox: Inbox, outbox: Outbox) -> None:
        for estimate in inbox.new("state/estimate"):
            self._heed(estimate)
        if self._last is not None and self._last.valid:
            self.map.follow(self._last.p_WB)
        for event in inbox.new("fsm/event"):
            self.map.note(event)
        if self._vision:
            self._look(t, inbox)
            if self.map.seen_t is not None and t >= self._publish_t:
                self._publish_t = t + self._settings.publish_s
                outbox.publish("map/elevation", self.map.message(t))
            self.trouble = self._refused or self._blind(t)
        for request in inbox.new("foothold/request"):
            outbox.publish("foothold/regions", self._answer(request, t))

    def snapshot(self) -> dict[str, Any]:
        state = self.map.snapshot(heights=self._vision)
        state["last"] = encode(self._last) if self._last is not None else b""
        if self._vision:
            state |= {"waiting": self._match.snapshot(), "refused": self._refused, "publish_t": self._publish_t}
        return state

    def restore(self, state: dict[str, Any]) -> None:
        self.map.restore(state)
        self._last = decode(StateEstimate, state["last"]) if state["last"] else None
        if self._vision:
            self._match.restore(state["waiting"])
            self._refused, self._publish_t = state["refused"], state["publish_t"]

    def _heed(self, estimate: StateEstimate) -> None:
        """An estimate that starts again leaves the map behind in a frame that is gone."""
        last, self._last = self._last, estimate
        if not estimate.valid or (last is not None and self._jumped(last, estimate)):
            self.map.clear()
            self._match.clear()
        if estimate.valid:
            self._match.add_estimate(estimate)

    def _jumped(self, last: StateEstimate, estimate: StateEstimate) -> bool:
        reach = self._settings.jump_m + _BASE_SPEED * abs(estimate.t - last.t)
        anew = self._new_boot_new_frame and estimate.boot != last.boot
        return bool(anew or np.linalg.norm(estimate.p_WB - last.p_WB) > reach)

    def _look(self, t: float, inbox: Inbox) -> None:
        for frame in inbox.new("hw/depth"):
            why = refusal(frame)
            if why:
                self._refused = f"the image of {frame.t:.3f} s is not used: {why}"
            else:
                self._match.add_frame(frame)
        reference = inbox.fresh("fsm/reference", t)
        pairs, dropped = self._match.matched(t)
        for frame, estimate in pairs:
            self.map.see(frame, estimate, reference)
            self._refused = ""
        self._refused = dropped or self._refused

    def _blind(self, t: float) -> str:
        """Why there is no map, in words; empty when there is one."""
        if not self._vision:
            return "blind: no depth sensor, so no map"
        if self.map.seen_t is None:
            return "no map: no image yet that could be used"
        age = t - self.map.seen_t
        limit = TOPICS["hw/depth"].stale_after_s
        return f"no map: the last good image is {age:.1f} s old, limit {limit:g} s" if age > limit else ""

    def _answer(self, request: FootholdRequest, t: float) -> FootholdRegions:
        why = self._blind(t)
        if why:
            return _whole_plane(request, t, (why,) * 4)
        return self._adaptation.regions(
            request, lambda p_W, half_x, half_y: self.map.patch(p_W, half_x, half_y, t)
        )


def _whole_plane(request: FootholdRequest, t: float, reasons: tuple[str, ...]) -> FootholdRegions:
    """Every foothold is its target and may be anywhere, for these reasons of the four legs."""
    return FootholdRegions(
        t=t, valid=True, id=request.id, foothold_WF=request.target_WF, safe=np.ones(4, bool), reasons=reasons
    )
