"""What was changed of the settings of a run that goes on already."""

from __future__ import annotations

from surefoot.bus.codec import decode
from surefoot.bus.messages import Tuning
from surefoot.bus.service_keys import KEPT
from surefoot.bus.session import Session
from surefoot.components.deployment_desk import ask_deployment
from surefoot.config.deployment import Deployment
from surefoot.config.deployment_file import deployment_text
from surefoot.config.tuning import shown, tuned, value_of
from surefoot.config.typed_toml import build, without_unknown


def tuned_already(session: Session) -> tuple[str, ...]:
    """Assignments `section.key=value`, the latest last; none where nothing was changed, or nobody answers."""
    kept = session.ask(f"{KEPT}/operator/tuning")
    return decode(Tuning, kept[-1]).assignment if kept else ()


class TunedRun:
    """One look at a run.

    Attributes:
        begun: the deployment that it began with.
        assignments: all that was set since, the latest last.
        now: the deployment that it goes by.
    """

    def __init__(self, begun: Deployment, assignments: tuple[str, ...]):
        """Of a run of which this is known.

        Raises:
            ConfigError: this version cannot be tuned so.
        """
        self.begun, self.assignments = begun, assignments
        self.now = tuned(begun, assignments)

    @classmethod
    def of(cls, session: Session) -> TunedRun:
        """Ask io.

        Raises:
            BusError: it does not answer.
            ConfigError: it runs with settings that this version cannot use.
        """
        begun: Deployment = build(Deployment, without_unknown(Deployment, ask_deployment(session))[0])
        return cls(begun, tuned_already(session))

    @property
    def changed(self) -> list[str]:
        """Paths of the settings that differ from what it began with, the latest last."""
        paths = [assignment.partition("=")[0] for assignment in self.assignments]
        return [path for path in paths if value_of(self.now, path) != value_of(self.begun, path)]

    def file_text(self) -> str:
        """A deployment with all that was changed, and beside each change what it was before."""
        remarks = {path: f"tuned; the run began with {shown(value_of(self.begun, path))}" for path in self.changed}
        return f"# A deployment as it was tuned while it ran.\n{deployment_text(self.now, remarks)}"
