"""What was changed of the settings of a run that goes on already."""

from __future__ import annotations

from surefoot.bus.codec import decode
from surefoot.bus.messages import Tuning
from surefoot.bus.service_keys import KEPT
from surefoot.bus.session import Session
from surefoot.components.deployment_desk import ask_deployment
from surefoot.config.deployment import Deployment
from surefoot.config.tuning import tuned
from surefoot.config.typed_toml import build, without_unknown


def tuned_already(session: Session) -> tuple[str, ...]:
    """Assignments `section.key=value`, the latest last; none where nothing was changed, or nobody answers."""
    kept = session.ask(f"{KEPT}/operator/tuning")
    return decode(Tuning, kept[-1]).assignment if kept else ()


class TunedRun:
    """One look at a run.

    Attributes:
        begun: the deployment that it began with.
        now: the one that it goes by.
        assignments: what differs, the latest change last.
    """

    def __init__(self, session: Session):
        """Ask io.

        Raises:
            BusError: it does not answer.
            ConfigError: it runs with settings that this version cannot use.
        """
        self.begun: Deployment = build(Deployment, without_unknown(Deployment, ask_deployment(session))[0])
        self.assignments = tuned_already(session)
        self.now = tuned(self.begun, self.assignments)
