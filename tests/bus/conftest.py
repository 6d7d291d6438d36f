"""Identities, and a hub that listens on loopback with mutual TLS and access control."""

import os
import socket
from dataclasses import replace

import pytest

from surefoot.bus.session import Session
from surefoot.config.network import Network
from surefoot.tools.keys import make_keys

HOSTS = {
    "robot": ("io", "estimator", "wbc"),
    "laptop": ("mpc", "fsm", "trajopt", "elevation_map"),
}


def free_port():
    """A TCP port of this machine that nobody uses."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


@pytest.fixture(scope="session")
def keys(tmp_path_factory):
    """A folder of identities."""
    folder = tmp_path_factory.mktemp("keys") / "keys"
    make_keys(folder, ["127.0.0.1", "localhost"], 30)
    return folder


@pytest.fixture(scope="module")
def network(keys):
    """The robot's side of a network of two hosts."""
    return Network(hosts=HOSTS, listen=f"tls/127.0.0.1:{free_port()}", address="127.0.0.1", keys_dir=str(keys))


@pytest.fixture(scope="module")
def hub(network):
    """The bus of that network, by its hub's session."""
    session = Session(f"access-{os.getpid()}", hub=True, network=network)
    yield session
    session.close()


@pytest.fixture
def laptop(network, hub):
    """A process on the other host."""
    session = Session(f"access-{os.getpid()}", connect_ms=10_000, network=replace(network, host="laptop"))
    yield session
    session.close()
