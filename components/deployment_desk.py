"""Where a recorder or a viewer that comes to a running stack learns what is running."""

from __future__ import annotations

import json
from typing import Any

from surefoot.bus.errors import BusError
from surefoot.bus.session import Session
from surefoot.config.deployment import Deployment
from surefoot.config.typed_toml import to_table

_KEY = "deployment"


def serve_deployment(session: Session, deployment: Deployment) -> None:
    """Answer who asks with the resolved configuration; by the process that holds the bus."""
    payload = json.dumps(to_table(deployment)).encode()
    session.serve(_KEY, lambda: [payload])


def ask_deployment(session: Session) -> dict[str, Any]:
    """The resolved configuration of the stack on this bus, as tables.

    Raises:
        BusError: nobody answers.
    """
    answers = session.ask(_KEY)
    if not answers:
        raise BusError("the stack on this bus does not say what is running: is it still starting?")
    return json.loads(answers[0])
