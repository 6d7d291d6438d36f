"""A word to a running stack."""

from __future__ import annotations

import time

_LEAVE_S = 0.3


def say_on_bus(namespace: str, key: str, text: str) -> None:
    """Put `text` on a key, and print where it went.

    Raises:
        BusError: no stack runs under that namespace.
    """
    from surefoot.bus.session import Session, socket_path

    session = Session(namespace, connect_ms=2000)
    session.put(key, text.encode())
    time.sleep(_LEAVE_S)  # let it leave before the session closes
    session.close()
    print(f"told {socket_path(namespace)}: {text}")
