"""The loopback address, where pages are served to this machine alone."""

from __future__ import annotations

import socket

from surefoot.tools.commands.call import CallError

HOST = "127.0.0.1"
"""A page is for this machine only: who can reach it needs no password."""

NAMES = (HOST, "localhost")
"""What a browser on this machine calls it."""


def listen(port: int) -> socket.socket:
    """A socket that listens on a port; 0 is any that is free.

    Raises:
        CallError: the port is taken, or is none.
    """
    try:
        return socket.create_server((HOST, port))
    except OverflowError:
        raise CallError(f"port {port}: there is 1 to 65535, and 0 for any that is free") from None
    except OSError as error:
        raise CallError(
            f"port {port} on {HOST} cannot be used ({error.strerror}): another page may be served there; choose "
            "another one, or 0 for any that is free"
        ) from None
