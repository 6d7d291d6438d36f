"""Over the network only the operator's certificate is heard, and only on what is its own to say."""

import json
import os
import re
import socket
import time
from pathlib import Path

import pytest
import zenoh
from cryptography import x509
from cryptography.hazmat.primitives.serialization import Encoding, load_pem_private_key
from cryptography.x509.oid import ExtendedKeyUsageOID

from surefoot.bus.access import access_control
from surefoot.bus.errors import BusError
from surefoot.bus.session import Session
from surefoot.bus.topics import TOPICS
from surefoot.config.network import Network
from surefoot.tools import keys as keys_module
from surefoot.tools.cli import main

NAMESPACE = f"access-{os.getpid()}"
ROBOTS = ("io", "estimator", "wbc")
ITS_OWN = [topic.key for topic in TOPICS.values() if topic.writer in ("mpc", "fsm", "trajopt", "elevation_map")]
OF_A_PROCESS = ("clock/done", "clock/hello", "log", "relief/ask", "relief/answer")
NOT_ITS_OWN = [
    *(topic.key for topic in TOPICS.values() if topic.key not in ITS_OWN),
    *(f"clock/release/{name}" for name in ("wbc", "mpc", "fsm")),
    *(f"{prefix}/{name}" for prefix in OF_A_PROCESS for name in ROBOTS),
    "anything",
]
PATIENCE_S = 30.0


class Ear:
    """All that a session hears."""

    def __init__(self, session):
        self.heard = []
        session.subscribe("**", lambda key, payload: self.heard.append((key, payload)))

    def wait(self, key, payload, again=lambda: None):
        """Until a message is heard; `again` says it until then."""
        end = time.monotonic() + PATIENCE_S
        while (key, payload) not in self.heard:
            assert time.monotonic() < end, f"{key} not heard"
            again()
            time.sleep(0.02)


@pytest.fixture
def intruder():
    """Opens sessions of somebody who uses Zenoh by himself, with the keys that he has."""
    opened = []

    def enter(network, mode="client", folder=None, name="", protocol="tls"):
        role = "connect" if mode == "client" else "listen"
        tls = {"verify_name_on_connect": False, "enable_mtls": True}
        if folder is not None:
            tls["root_ca_certificate"] = str(folder / "authority.pem")
        if name:
            tls[f"{role}_certificate"] = str(folder / f"{name}.pem")
            tls[f"{role}_private_key"] = str(folder / f"{name}.key")
        endpoint = network.listen.replace("tls/", f"{protocol}/")
        config = {
            "mode": mode,
            role: {"endpoints": [endpoint], "timeout_ms": 1500, "exit_on_failure": True},
            "scouting": {"multicast": {"enabled": False}, "gossip": {"enabled": False}},
            "transport": {"shared_memory": {"enabled": False}, "link": {"tls": tls}},
        }
        opened.append(zenoh.open(zenoh.Config.from_json5(json.dumps(config))))
        return opened[-1]

    yield enter
    for session in opened:
        session.close()


def signed_by(keys, folder, name, usage, addresses=(), days=1):
    """Another identity of the same authority."""
    root = x509.load_pem_x509_certificate((keys / "authority" / "authority.pem").read_bytes())
    root_key = load_pem_private_key((keys / "authority" / "authority.key").read_bytes(), None)
    key, certificate = keys_module._make_identity(name, addresses, usage, root_key, root, days)
    folder.mkdir()
    (folder / f"{name}.pem").write_bytes(certificate.public_bytes(Encoding.PEM))
    (folder / f"{name}.key").write_bytes(keys_module._private(key))
    (folder / "authority.pem").write_bytes(root.public_bytes(Encoding.PEM))
    return folder


def test_the_operator_hears_the_robot_and_speaks_for_its_own_processes(hub, laptop):
    robot, operator = Ear(hub), Ear(laptop)
    for key in ("hw/state", "sim/truth", "clock/release/mpc"):
        operator.wait(key, b"robot", lambda key=key: hub.put(key, b"robot"))
    for key in (
        *ITS_OWN,
        "operator/request",
        "operator/tune",
        "operator/beat",
        "supervisor/request",
        *(f"{prefix}/mpc" for prefix in OF_A_PROCESS),
    ):
        robot.wait(key, b"laptop", lambda key=key: laptop.put(key, b"laptop"))


def test_the_operator_cannot_speak_for_io_the_robots_processes_or_the_clock(hub, laptop):
    robot = Ear(hub)
    robot.wait("mpc/policy", b"first", lambda: laptop.put("mpc/policy", b"first"))
    for key in NOT_ITS_OWN:
        laptop.put(key, b"forged")
    # What follows on the same link has overtaken nothing.
    robot.wait("mpc/policy", b"last", lambda: laptop.put("mpc/policy", b"last"))
    assert [key for key, payload in robot.heard if payload == b"forged"] == []
    assert {"hw/state", "joint/command", "operator/command", "status/io"} <= set(NOT_ITS_OWN)


def test_the_operator_answers_for_its_own_processes_only(hub, laptop):
    laptop.serve("log/mpc", lambda: [b"its own"])
    for key in ("log/wbc", "kept/hw/state", "kept/mpc/policy"):
        laptop.serve(key, lambda: [b"forged"])
    hub.serve("kept/joint/command", lambda: [b"robot"])
    end = time.monotonic() + PATIENCE_S
    while hub.ask("log/mpc") != [b"its own"]:
        assert time.monotonic() < end
    for key in ("log/wbc", "kept/hw/state", "kept/mpc/policy"):
        assert not hub.ask(key, 0.5), key
    assert laptop.ask("kept/joint/command") == [b"robot"]


@pytest.mark.parametrize(
    "who", ["no certificate", "no tls", "foreign authority", "expired", "the robot's certificate"]
)
def test_without_the_operators_certificate_nobody_gets_in(intruder, network, hub, keys, who, tmp_path):
    if who == "no certificate":
        given = {"folder": keys / "operator"}
    elif who == "no tls":
        given = {"protocol": "tcp"}
    elif who == "foreign authority":
        keys_module.make_keys(tmp_path / "foreign", ["127.0.0.1"], 1)
        foreign = tmp_path / "foreign" / "operator"
        (foreign / "authority.pem").write_bytes((keys / "operator" / "authority.pem").read_bytes())
        given = {"folder": foreign, "name": "operator"}
    elif who == "expired":
        usage = ExtendedKeyUsageOID.CLIENT_AUTH
        given = {"folder": signed_by(keys, tmp_path / "old", "operator", usage, days=0), "name": "operator"}
        time.sleep(1.1)  # a certificate's dates are in whole seconds
    else:
        given = {"folder": keys / "robot", "name": "robot"}  # it serves; it is no key to come in with
    with pytest.raises(zenoh.ZError):
        intruder(network, **given)
    intruder(network, folder=keys / "operator", name="operator")  # the same way in, with the right key


def test_another_name_of_the_same_authority_hears_and_says_nothing(intruder, network, hub, laptop, keys, tmp_path):
    folder = signed_by(keys, tmp_path / "viewer", "viewer", ExtendedKeyUsageOID.CLIENT_AUTH)
    viewer = intruder(network, folder=folder, name="viewer")
    robot, operator, heard = Ear(hub), Ear(laptop), []

    def hear(sample):
        heard.append(sample.payload.to_bytes())

    for expression in ("**", f"{NAMESPACE}/**", f"{NAMESPACE}/hw/state"):
        viewer.declare_subscriber(expression, hear)
    hub.serve("kept/joint/command", lambda: [b"robot"])
    keys_tried = (*ITS_OWN, *NOT_ITS_OWN, "operator/request")
    forged = [viewer.declare_publisher(f"{NAMESPACE}/{key}") for key in keys_tried]
    for _ in range(5):
        for publisher in forged:
            publisher.put(b"viewer")
        hub.put("hw/state", b"robot")
        time.sleep(0.1)
    operator.wait("hw/state", b"robot")
    robot.wait("mpc/policy", b"laptop", lambda: laptop.put("mpc/policy", b"laptop"))
    assert set(heard) == {b"viewer"}, "it hears itself, without the network, and nobody else"
    assert not any(payload == b"viewer" for _, payload in robot.heard + operator.heard)
    assert [reply for reply in viewer.get(f"{NAMESPACE}/kept/joint/command/*", timeout=0.5) if reply.ok] == []


def test_the_operators_certificate_cannot_pass_for_the_robot(intruder, keys, tmp_path):
    """Whoever has it and the robot's address cannot open a hub that other machines take for the robot's."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        listen = f"tls/127.0.0.1:{probe.getsockname()[1]}"
    network = Network(listen=listen, address="127.0.0.1", keys_dir=str(keys), host="operator")
    folder = signed_by(keys, tmp_path / "forged", "operator", ExtendedKeyUsageOID.CLIENT_AUTH, ["127.0.0.1"])
    intruder(network, "router", folder, "operator")
    with pytest.raises(BusError, match="A refused certificate looks the same"):
        Session(NAMESPACE, connect_ms=1500, network=network)


def test_the_default_is_one_machine_closed_to_others(network, hub):
    before = set(_sockets())
    closed = Session(f"closed-{os.getpid()}", hub=True)
    client = Session(f"closed-{os.getpid()}", connect_ms=2000)
    assert set(_sockets()) == before
    client.close()
    closed.close()
    port = int(network.listen.rsplit(":", 1)[1])
    listening = [each for each in before if each[3] == "0A"]
    assert ("tcp", "0100007F", port, "0A") in listening  # 127.0.0.1, and in this process:
    assert not any(protocol.startswith("udp") for protocol, *_ in before), "multicast or scouting"


def test_a_command_comes_in_by_the_deployment_and_the_operators_keys(network, hub, tmp_path, capsys):
    config, port = tmp_path / "two.toml", network.listen.rsplit(":", 1)[1]
    config.write_text(
        f'[terrain]\nkind = "flat"\n[run]\nnamespace = "{NAMESPACE}"\n[network]\nlisten = "{network.listen}"\n'
        f'address = "127.0.0.1"\nkeys_dir = "{network.keys_dir}"\n'
    )
    robot = Ear(hub)
    assert main(["command", "stand", "--connect", str(config)]) == 1  # it goes out; nobody is there to obey
    robot.wait("operator/request", b"stand")
    assert main(["restart", "mpc", "--connect", str(config)]) == 0
    robot.wait("supervisor/request", b"restart mpc")
    assert f"told tls/127.0.0.1:{port}: stand" in capsys.readouterr().out
    assert main(["status", "--connect", str(config)]) == 1  # connected; nobody speaks
    assert f"connected to tls/127.0.0.1:{port}" in capsys.readouterr().out


def test_without_another_host_the_operator_may_only_ask():
    rules = {rule["id"]: rule for rule in access_control(Network(listen="tls/0.0.0.0:7448"), "ns")["rules"]}
    asked = ["operator/request", "operator/tune", "operator/beat", "supervisor/request"]
    assert rules["say"]["key_exprs"] == [f"ns/{key}" for key in asked]
    assert "answer" not in rules


def _sockets():
    """(protocol, hexadecimal address, port, state) of each Internet socket of this process."""
    inodes = set()
    for descriptor in Path("/proc/self/fd").iterdir():
        try:
            inodes |= set(re.findall(r"socket:\[(\d+)\]", os.readlink(descriptor)))
        except FileNotFoundError:
            continue
    for protocol in ("tcp", "tcp6", "udp", "udp6"):
        for line in Path(f"/proc/self/net/{protocol}").read_text().splitlines()[1:]:
            words = line.split()
            if words[9] in inodes:
                address, port = words[1].split(":")
                yield protocol, address, int(port, 16), words[3]
