"""`surefoot keys`: the identities of a network of machines."""

from __future__ import annotations

import argparse
from pathlib import Path

from surefoot.tools.commands.call import CallError

_INIT = """\
Make an authority, the robot's identity and the operator's in a new folder.

Copy DIR/robot to the robot's computer and DIR/operator to the operator's, each into the folder that the
deployment's network.keys_dir names. DIR/authority signs further identities: keep it on neither, offline.

exit code: 0 made; 2 the call was wrong, or the folder is there already
"""
_SHOW = """\
Whose identities a folder holds, by whom they were signed and until when they are valid.

exit code: 0 all can be used; 1 one cannot; 2 the call was wrong
"""


def add(commands: argparse._SubParsersAction) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser("keys", help="make and show the identities of a network")
    verbs = parser.add_subparsers(required=True, metavar="init|show")
    init = verbs.add_parser(
        "init",
        help="make them",
        formatter_class=argparse.RawDescriptionHelpFormatter,
        description=_INIT,
        epilog="example: surefoot keys init keys --robot 192.168.123.10 robot.local",
    )
    init.add_argument("folder", type=Path, metavar="DIR", help="a new folder")
    init.add_argument(
        "--robot",
        nargs="+",
        default=["localhost", "127.0.0.1"],
        metavar="ADDRESS",
        help="names and IP addresses by which the operator's machine reaches the robot; default: localhost",
    )
    init.add_argument("--days", type=int, default=365, help="how long they are valid")
    init.set_defaults(run=_init)
    show = verbs.add_parser(
        "show",
        help="whose they are, until when, and whether they can be used",
        formatter_class=argparse.RawDescriptionHelpFormatter,
        description=_SHOW,
        epilog="example: surefoot keys show keys",
    )
    show.add_argument("folder", type=Path, metavar="DIR")
    show.set_defaults(run=_show)


def _init(call: argparse.Namespace) -> int:
    keys = _maker()
    if not 1 <= call.days <= 3650:
        raise CallError(f"--days {call.days}: allowed 1 to 3650")
    for address in call.robot:
        if not address or "/" in address or any(letter.isspace() for letter in address) or not address.isascii():
            raise CallError(f"--robot {address!r}: a host name or an IP address")
    folder = call.folder
    keys.make_keys(folder, call.robot, call.days)
    print(f"made an authority and two identities in {folder}, valid for {call.days} days")
    print(f"to the robot's computer:     {folder}/robot/     (reached by {', '.join(call.robot)})")
    print(f"to the operator's computer:  {folder}/operator/")
    print(f"keep apart, on neither:      {folder}/authority/")
    print("copy each folder whole and over a channel you trust, such as scp -pr, into network.keys_dir there")
    return 0


def _show(call: argparse.Namespace) -> int:
    from datetime import UTC, datetime

    found = _maker().shown(call.folder)
    for identity in found:
        if identity.until is not None:
            days = (identity.until - datetime.now(UTC)).days
            reached = f", reached by {', '.join(identity.addresses)}" if identity.name == "robot" else ""
            print(
                f"{identity.name}: valid until {identity.until:%Y-%m-%d} ({days} days), "
                f"authority {identity.authority}{reached}"
            )
        if identity.trouble:
            print(f"{identity.name}: cannot be used: {identity.trouble}")
    return 1 if any(identity.trouble for identity in found) else 0


def _maker():
    try:
        from surefoot.tools import keys
    except ImportError:
        raise CallError("keys need the package cryptography: pip install 'surefoot[network]'") from None
    return keys
