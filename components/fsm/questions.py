"""What the state machine asks of the map and of the trajectory optimisation, and which answers are its own."""

from __future__ import annotations

import numpy as np

from surefoot.bus.messages import FootholdRegions, FootholdRequest, Plan, PlanRequest
from surefoot.components.component import Outbox
from surefoot.components.memory import Memory


class Questions:
    """Requests to publish, each with an id by which its answer is known: an answer to an older one is ignored.

    Attributes:
        foothold_request, plan_request: to publish, or None.
    """

    memory = Memory("_id", foothold_request=FootholdRequest, plan_request=PlanRequest)

    def __init__(self) -> None:
        self.foothold_request: FootholdRequest | None = None
        self.plan_request: PlanRequest | None = None
        self._id = 0

    def ask_regions(self, t: float, target_WF: np.ndarray, normal_W: np.ndarray, **figures) -> None:
        """SEND: the safe regions around targets (4, 3) [m]; `figures` are the request's other fields."""
        self._id += 1
        self.foothold_request = FootholdRequest(
            t=t, valid=True, id=self._id, target_WF=target_WF, normal_W=normal_W, **figures
        )

    def ask_plan(self, t: float, answer: FootholdRegions, normal_W: np.ndarray, **figures) -> None:
        """OPT: a stride to the footholds of an answer; `figures` are the other fields of a `PlanRequest`.

        Of a leg that is not moved now the answer may know no safe foothold: its target stands in, without a
        region. It shapes the forces that the stride asks of the moved foot, and nobody steps there: before that
        leg is moved the map is asked again.
        """
        self.plan_request = PlanRequest(
            t=t,
            valid=True,
            id=self._id,
            target_WF=answer.foothold_WF,
            region_a=answer.region_a,
            region_b=answer.region_b,
            region_active=answer.region_active,
            normal_W=normal_W,
            **figures,
        )

    def send(self, outbox: Outbox) -> None:
        """Publish what is to be asked, once."""
        if self.foothold_request is not None:
            outbox.publish("foothold/request", self.foothold_request)
            self.foothold_request = None
        if self.plan_request is not None:
            outbox.publish("trajopt/request", self.plan_request)
            self.plan_request = None

    def answered_by(self, message: FootholdRegions | Plan) -> bool:
        """Whether a message answers the last question."""
        return message.id == self._id
