"""Which host is the hub, what runs where, and how the hub is reached."""

from dataclasses import replace

import pytest

from surefoot.bus.topics import PROCESSES
from surefoot.config.network import COMPONENTS, Network
from surefoot.config.typed_toml import ConfigError

HOSTS = {"desk": ("fsm", "trajopt"), "dog": ("io", "estimator", "wbc", "mpc"), "truck": ("elevation_map",)}
NETWORK = Network(hosts=HOSTS, listen="tls/0.0.0.0:7448", address="dog.local")


def test_the_components_are_those_of_the_process_table():
    assert tuple(PROCESSES) == COMPONENTS


def test_the_host_of_io_is_the_hub_whatever_its_name():
    assert NETWORK.hub == "dog" and NETWORK.here == "dog" and NETWORK.at_hub
    assert NETWORK.components_here == HOSTS["dog"]
    assert NETWORK.components_away == ("fsm", "trajopt", "elevation_map")
    truck = replace(NETWORK, host="truck")
    assert not truck.at_hub and truck.components_here == ("elevation_map",)
    assert replace(NETWORK, host="operator").components_here == ()


def test_the_hub_is_reached_by_its_address_at_the_port_where_it_listens():
    assert NETWORK.hub_endpoint == "tls/dog.local:7448"
    assert replace(NETWORK, address="fe80::1").hub_endpoint == "tls/[fe80::1]:7448"
    with pytest.raises(ConfigError, match=r"network\.listen is empty: robot cannot be reached"):
        _ = Network(address="dog.local").hub_endpoint
    with pytest.raises(ConfigError, match=r"network\.address is empty"):
        _ = Network(listen="tls/0.0.0.0:7448").hub_endpoint
