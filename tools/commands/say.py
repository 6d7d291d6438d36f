"""A word to a running stack."""

from __future__ import annotations

import argparse
import time

from surefoot.tools.commands.bus_call import open_bus

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
