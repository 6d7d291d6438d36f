"""Which running stack a command speaks to."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from surefoot.tools.commands.call import deployment_file

if TYPE_CHECKING:
    from surefoot.bus.session import Session

_CONNECT_MS = 2000


def add_bus_arguments(parser: argparse.ArgumentParser) -> None:
    """Add what says where the stack runs."""
    parser.add_argument("--namespace", default="surefoot", help="of a stack on this machine; default surefoot")
    parser.add_argument(
        "--connect",
        metavar="CONFIG",
        help="a stack on another machine, by the [network] of its deployment and this machine's operator keys",
    )


def open_bus(call: argparse.Namespace) -> Session:
    """The bus of that stack.

    Raises:
        BusError: no stack runs there, or it refuses this machine.
        ConfigError: the deployment cannot be used, or has no way in from another machine.
    """
    from dataclasses import replace

    from surefoot.bus.session import Session
    from surefoot.config.deployment import load_deployment
    from surefoot.config.network import OPERATOR

    if call.connect is None:
        return Session(call.namespace, connect_ms=_CONNECT_MS)
    deployment = load_deployment(deployment_file(call.connect))
    network = replace(deployment.network, host=OPERATOR)
    return Session(deployment.run.namespace, connect_ms=_CONNECT_MS, network=network)
