"""Where the hub of a namespace listens on this machine, and which process it is."""

from __future__ import annotations

import os
import socket
import stat
import tempfile
from pathlib import Path

from surefoot.bus.errors import BusError

_CONNECT_S = 1.0


def socket_path(namespace: str) -> Path:
    """Where the bus of a namespace listens; one folder a user and namespace."""
    return Path(tempfile.gettempdir()) / f"surefoot-{os.getuid()}" / f"{namespace}.sock"


def hub_owner(namespace: str) -> str:
    """In words the process that serves a namespace on this machine, also while it is stopped; empty: none does."""
    path = socket_path(namespace)
    with socket.socket(socket.AF_UNIX) as probe:
        probe.settimeout(_CONNECT_S)
        try:
            probe.connect(str(path))
        except (BlockingIOError, TimeoutError):
            pass  # it has not accepted any for a while
        except OSError:
            return ""  # no socket, or one left by a process that is gone
    owner = _owner_file(path)
    return f"process {owner.read_text().strip()}" if owner.exists() else "a process"


def refuse_second_hub(namespace: str) -> None:
    """See that no hub serves a namespace yet.

    Raises:
        BusError: one does; says which process.
    """
    if owner := hub_owner(namespace):
        raise BusError(f"{owner} already serves namespace {namespace!r}: stop it, or set another run.namespace")


def check_folder(namespace: str) -> None:
    """See that nobody but this user may enter the socket's folder: that is all the trust there is on this machine.

    Raises:
        BusError: somebody else has made it, or it has been opened to others.
    """
    folder = socket_path(namespace).parent
    if not os.path.lexists(folder):
        return
    found = folder.lstat()
    mode = stat.S_IMODE(found.st_mode)
    if not stat.S_ISDIR(found.st_mode) or found.st_uid != os.getuid() or mode & 0o077:
        raise BusError(
            f"{folder} is not a folder of user {os.getuid()} alone (of user {found.st_uid}, mode {mode:04o}): "
            "others could join the bus, or pass for it; remove it"
        )


def take_socket(namespace: str) -> None:
    """Make this process the one that serves a namespace.

    Raises:
        BusError: another process serves it, or others may enter the socket's folder.
    """
    path = socket_path(namespace)
    path.parent.mkdir(mode=0o700, exist_ok=True)
    check_folder(namespace)
    refuse_second_hub(namespace)
    path.unlink(missing_ok=True)  # left by a process that is gone
    path.with_name(path.name + ".lock").unlink(missing_ok=True)
    _owner_file(path).write_text(str(os.getpid()))


def _owner_file(path: Path) -> Path:
    return path.with_suffix(".pid")
