"""The settings that a run goes by at the moment which is shown."""

from __future__ import annotations

from surefoot.config.deployment import Deployment
from surefoot.config.typed_toml import ConfigError
from surefoot.tools.teleop.tuned_run import TunedRun


class SettingsWatch:
    """Goes along with what is changed.

    Attributes:
        run: what is shown; None while it is not known.
        trouble: in words which changes this version cannot use; empty when it can.
    """

    def __init__(self) -> None:
        self.run: TunedRun | None = None
        self.trouble = ""
        self._assignments: tuple[str, ...] = ()

    def follow(self, deployment: Deployment | None, assignments: tuple[str, ...]) -> None:
        """Take in what is known by now.

        Args:
            deployment: that the run began with; None while it is not known. Another object: another run.
            assignments: all that was changed since.
        """
        if deployment is None:
            self.run, self.trouble = None, ""
            return
        if self.run is not None and self.run.begun is deployment and self._assignments == assignments:
            return
        self._assignments, self.trouble = assignments, ""
        try:
            self.run = TunedRun(deployment, assignments)
        except ConfigError as error:
            self.run = TunedRun(deployment, ())
            self.trouble = f"the run was tuned as this version cannot be, what it began with is shown: {error}"
