"""Where the picture comes from: one small interface for a running stack and for a recording."""

from __future__ import annotations

from typing import Protocol

from surefoot.config.deployment import Deployment
from surefoot.tools.picture import Picture
from surefoot.tools.view.heard import Heard


class Source(Protocol):
    """What the view looks at.

    Attributes:
        title: what that is.
        deployment: of the run; None while it is not known. Another object: another run.
        heard: what is known by now.
        picture: of the run's processes; None where nobody tells of them.
        words: what a person should know of the source; empty when all is well.
    """

    @property
    def title(self) -> str: ...

    @property
    def deployment(self) -> Deployment | None: ...

    @property
    def heard(self) -> Heard: ...

    @property
    def picture(self) -> Picture | None: ...

    @property
    def words(self) -> str: ...

    def look(self) -> None:
        """Take in what is new."""
        ...

    def close(self) -> None:
        """Look no more."""
        ...
