"""Where a recorder or a viewer that comes to a running stack learns what is running."""

from __future__ import annotations

import json
from typing import Any

from surefoot.bus.errors import BusError
from surefoot.bus.service_keys import DEPLOYMENT
from surefoot.bus.session import Session
from surefoot.config.deployment import Deployment
from surefoot.config.typed_toml import to_table


def serve_deployment(session: Session, deployment: Deployment) -> None:
    """Answer who asks with the resolved configuration; by the process that holds the bus."""
    serve_tables(session, to_table(deployment))


def serve_tables(session: Session, tables: dict[str, Any]) -> None:
    """The same of a configuration that is given as tables, such as a recording's."""
    payload = json.dumps(tables).encode()
    session.serve(DEPLOYMENT, lambda: [payload])


def ask_deployment(session: Session) -> dict[str, Any]:
    """The resolved configuration of the stack on this bus, as tables.

    Raises:
        BusError: nobody answers.
    """
    answers = session.ask(DEPLOYMENT)
    if not answers:
        raise BusError("the stack on this bus does not say what is running: is it still starting?")
    return json.loads(answers[0])
