"""Where whoever comes to a running stack learns what is running: a recorder, a process that is to join it."""

from __future__ import annotations

import json
import time
from collections.abc import Callable
from typing import Any

from surefoot.bus.errors import BusError
from surefoot.bus.service_keys import DEPLOYMENT
from surefoot.bus.session import Session
from surefoot.config.deployment import Deployment
from surefoot.config.shared_settings import differences
from surefoot.config.typed_toml import to_table

_ASK_AGAIN_S = 0.2
_NAMED = 3  # settings, of those that differ


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


def check_settings(
    session: Session, deployment: Deployment, who: str, ended: Callable[[], bool] = lambda: False
) -> None:
    """See that io runs with the same settings; waits until it says with which, or until `ended()`.

    Args:
        session: the bus.
        deployment: the settings here.
        who: has them, for the error's words.
        ended: there is no reason to wait on.

    Raises:
        BusError: io runs with others; names them.
    """
    while True:
        try:
            found = differences(to_table(deployment), ask_deployment(session))
            break
        except BusError:  # it comes up, or the link is down
            if ended():
                return
            time.sleep(_ASK_AGAIN_S)
    if found:
        more = f" and {len(found) - _NAMED} more" if len(found) > _NAMED else ""
        raise BusError(
            f"{who} has other settings than io: {', '.join(found[:_NAMED])}{more}; "
            "give every machine the same file and the same --set"
        )
