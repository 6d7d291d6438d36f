"""Where the hub of a bus listens and how another machine reaches it, as Zenoh's configuration."""

from __future__ import annotations

from surefoot.bus.access import access_control
from surefoot.bus.identity import Identity, check_identity, identity_of
from surefoot.config.network import Network


def hub_side(network: Network, namespace: str, local: str) -> dict:
    """What the hub listens on: the local endpoint, and the network's if there is one.

    Raises:
        KeysError: the robot's identity cannot be used.
    """
    if not network.listen:
        return {"listen": {"endpoints": [local]}}
    side: dict = {
        "listen": {"endpoints": [local, network.listen]},
        "access_control": access_control(network, namespace),
    }
    check_keys(network)
    if network.encrypted:
        side["tls"] = _tls(identity_of(network), "listen")
    return side


def client_side(network: Network) -> dict:
    """How a process on another machine than io's connects.

    Raises:
        KeysError: the operator's identity cannot be used.
        ConfigError: the hub does not listen to other machines.
    """
    side: dict = {"connect": {"endpoints": [network.hub_endpoint]}}
    check_keys(network)
    if network.encrypted:
        side["tls"] = _tls(identity_of(network), "connect")
    return side


def check_keys(network: Network) -> None:
    """See that this machine's identity can be used, if the deployment needs one.

    Raises:
        KeysError: it cannot.
    """
    if network.encrypted:
        check_identity(identity_of(network), network.address if network.at_hub else "")


def _tls(identity: Identity, role: str) -> dict:
    return {
        "root_ca_certificate": str(identity.authority.absolute()),
        f"{role}_certificate": str(identity.certificate.absolute()),
        f"{role}_private_key": str(identity.key.absolute()),
        "enable_mtls": True,
        "verify_name_on_connect": True,
    }
