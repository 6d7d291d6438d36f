"""A word to a running stack."""

from __future__ import annotations

import argparse
import time
from typing import TYPE_CHECKING

from surefoot.tools.commands.bus_call import open_bus

if TYPE_CHECKING:
    from surefoot.tools.teleop.remote import Remote

_LEAVE_S = 0.3


def say_on_bus(call: argparse.Namespace, key: str, text: str) -> None:
    """Put `text` on a key of the stack that was called, and print where it went.

    Raises:
        BusError: no stack runs there.
    """
    session = open_bus(call)
    session.put(key, text.encode())
    time.sleep(_LEAVE_S)  # let it leave before the session closes
    session.close()
    print(f"told {session.where}: {text}")


def say_at_once(call: argparse.Namespace, word: str) -> int:
    """Say a command that cannot wait to the stack that was called; the exit code is 0 if the robot obeys.

    Raises:
        BusError: no stack runs there.
    """
    from surefoot.tools.teleop.remote import Remote

    session = open_bus(call)
    try:
        return say_command(Remote(session, beats=False, settles=False), session.where, word)
    finally:
        session.close()


def say_command(remote: Remote, where: str, words: str) -> int:
    """Say a command, print where it went and what becomes of it; the exit code is 0 if the robot obeys."""
    answer = remote.ask(words)
    print(f"told {where}: {words}", flush=True)
    found = answer()
    print(found.words if found.taken else f"refused: {found.words}")
    return 0 if found.taken else 1
