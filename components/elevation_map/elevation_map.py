"""The elevation map's process. Without a depth sensor there is no map, and the whole plane is allowed."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from surefoot.bus.messages import FootholdRegions
from surefoot.components.component import Component, Inbox, Outbox


class ElevationMap(Component):
    """Answers every foothold request (SEND of Fig. 6).

    Sec. II-B.5: when no map is available, the safe region defaults to the entire plane and the adapted
    footholds are the targets themselves.
    """

    name: ClassVar[str] = "elevation_map"
    inputs: ClassVar[tuple[str, ...]] = ("foothold/request",)
    outputs: ClassVar[tuple[str, ...]] = ("foothold/regions",)

    def step(self, t: float, inbox: Inbox, outbox: Outbox) -> None:
        for request in inbox.new("foothold/request"):
            answer = FootholdRegions(
                t=t,
                valid=True,
                id=request.id,
                foothold_WF=request.target_WF,
                safe=np.ones(4, bool),
                reasons=("blind: no depth sensor, so no map",) * 4,
            )
            outbox.publish("foothold/regions", answer)
