"""The emulator answers whoever speaks to it, from the socket it was spoken to on, and never of its own accord."""

import socket
from dataclasses import replace

import pytest
from emulation import PATIENT, emulator
from packet_samples import GOOD_LAW, PLAUSIBILITY, READING

from surefoot.config.aliengo import Aliengo
from surefoot.config.deployment import Deployment
from surefoot.config.emulator import Emulator, Wire
from surefoot.config.hw import Hw
from surefoot.hw.aliengo.command_packet import encode_command
from surefoot.hw.aliengo.generation import G1
from surefoot.hw.aliengo.state_packet import decode_state
from surefoot.hw.emulator.server import EmulatorServer
from surefoot.hw.errors import HardwareFault

COMMAND = encode_command(GOOD_LAW, G1, PLAUSIBILITY)[0]
SOUND = Wire(latency_s=0.0, jitter_s=0.0)


def deployment(pace="packets", commands=SOUND, states=SOUND, **settings):
    wire = Emulator(pace=pace, commands=commands, states=states, **settings)
    return Deployment(hw=Hw(start="lying", aliengo=Aliengo(**PATIENT)), emulator=wire)


class Client:
    """A socket that, as the vendor's, hears the address alone that it speaks to."""

    def __init__(self, emulation):
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.settimeout(60.0)
        self._socket.connect(("127.0.0.1", emulation.server.port))

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._socket.close()

    def say(self, packet=COMMAND):
        self._socket.send(packet)

    def hears(self):
        """The tick of the next state."""
        return decode_state(self._socket.recv(2048), G1, READING, PLAUSIBILITY).tick

    def ask(self, packet=COMMAND):
        self.say(packet)
        return self.hears()

    def hears_nothing_before(self, tick):
        """Whether the next thing that comes is the answer that is known to come."""
        return self.hears() == tick


def test_each_command_takes_a_cycle_and_is_answered_once():
    with emulator(deployment()) as there, Client(there) as client:
        assert [client.ask() for _ in range(20)] == [2000 * n for n in range(1, 21)]
    assert there.server.answers == there.robot.commands == 20 and there.robot.t == pytest.approx(0.040)


def test_each_client_gets_its_own_answers():
    with emulator(deployment()) as there, Client(there) as one, Client(there) as other:
        assert [one.ask(), other.ask(), one.ask(), other.ask()] == [2000, 4000, 6000, 8000]


def test_what_is_no_command_takes_a_cycle_and_gets_no_answer():
    with emulator(deployment()) as there, Client(there) as client:
        for garbage in (COMMAND[:-1], bytes(610), b"hello"):
            client.say(garbage)
        client.say()
        assert client.hears_nothing_before(8000) and there.robot.refused == 3


def test_a_lost_command_takes_a_cycle_too():
    with emulator(deployment(commands=replace(SOUND, loss=1.0))) as there, Client(there) as client:
        for _ in range(20):
            client.say()
        while there.robot.t < 0.0399:
            pass
    assert there.robot.commands == there.server.answers == 0 and there.robot.t == pytest.approx(0.040)


def test_latency_of_whole_cycles_is_that_many_packets():
    with (
        emulator(deployment(states=Wire(latency_s=0.0041, jitter_s=0.0))) as there,
        Client(there) as client,
    ):
        for _ in range(6):
            client.say()
        assert [client.hears() for _ in range(4)] == [2000, 4000, 6000, 8000]


def test_at_the_walls_pace_the_robots_time_goes_on_by_itself():
    with emulator(deployment(pace="wall")) as there, Client(there) as client:
        first = client.ask()
        while client.ask() == first:
            pass
    assert there.robot.commands >= 2 and there.server.answers == there.robot.commands


def test_a_port_that_is_taken_is_named_with_what_to_do():
    named = r"UDP port \d+ at 127\.0\.0\.1: .* give --port"
    with emulator(deployment()) as there, pytest.raises(HardwareFault, match=named):
        EmulatorServer(deployment(), port=there.server.port)
