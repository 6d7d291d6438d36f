"""The emulator answers whoever speaks to it, from the socket it was spoken to on, and never of its own accord."""

import socket
from dataclasses import replace

import numpy as np
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
from surefoot.hw.aliengo.turn import Turn, decode_turn, encode_turn
from surefoot.hw.emulator.link_faults import LinkFaults
from surefoot.hw.emulator.server import EmulatorServer
from surefoot.hw.errors import HardwareFault

COMMAND = encode_command(GOOD_LAW, G1, PLAUSIBILITY)[0]
SOUND = Wire(latency_s=0.0, jitter_s=0.0)


def deployment(pace="packets", commands=SOUND, states=SOUND, seed=0, **settings):
    wire = Emulator(pace=pace, commands=commands, states=states, **settings)
    hw = Hw(start="lying", seed=seed, command_delay_s=0.0, aliengo=Aliengo(**PATIENT))
    return Deployment(hw=hw, emulator=wire)


def turn(number):
    return encode_turn(Turn(number, (COMMAND,)))


def laws_that_act(robot):
    """A list of what the motors follow, a physics step each."""
    acting, write = [], robot.plant.write

    def noted(law, steps_later=0):
        acting.append(law)
        write(law, steps_later)

    robot.plant.write = noted
    return acting


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

    def answer_to(self, datagram):
        """The next datagram after one."""
        self.say(datagram)
        return self._socket.recv(2048)

    def takes_turn(self, number):
        """The ticks of the states that a turn brings."""
        answer = decode_turn(self.answer_to(turn(number)))
        assert answer.number == number
        return [decode_state(packet, G1, READING, PLAUSIBILITY).tick for packet in answer.packets]

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


@pytest.mark.parametrize(
    ("latency_s", "cycles"), [(0.0, 0), (0.0003, 1), (0.002, 1), (0.0021, 2), (0.004, 2), (0.0045, 3)]
)
def test_a_state_is_as_old_as_its_way_is_long_in_whole_cycles(latency_s, cycles):
    states = Wire(latency_s=latency_s, jitter_s=0.0)
    with emulator(deployment(states=states, tick_start=100)) as there, Client(there) as client:
        came = [client.takes_turn(n) for n in range(1, 9)]
    assert came == [[]] * cycles + [[100 + 2000 * n] for n in range(1, 9 - cycles)]


@pytest.mark.parametrize(("latency_s", "ms"), [(0.0, 0), (0.0003, 1), (0.002, 2), (0.0021, 3), (0.004, 4)])
def test_a_command_acts_from_the_first_millisecond_on_at_which_it_has_arrived(latency_s, ms):
    commands = Wire(latency_s=latency_s, jitter_s=0.0)
    with emulator(deployment(commands=commands)) as there, Client(there) as client:
        laws = laws_that_act(there.robot)
        for n in range(1, 5):
            client.takes_turn(n)
    assert [law.kp[0] == GOOD_LAW.kp[0] for law in laws] == [False] * ms + [True] * (8 - ms)


def test_a_lost_command_lets_the_last_one_go_on_and_asks_for_no_state():
    with emulator(deployment()) as there, Client(there) as client:
        client.takes_turn(1)
        there.server._commands = LinkFaults(replace(SOUND, loss=1.0), np.random.default_rng(0))
        assert client.takes_turn(2) == [] and there.robot.commands == 1
        assert (there.robot._motors.law(there.robot.t).kp == GOOD_LAW.kp).all()
    assert there.robot.t == pytest.approx(0.004)


def test_a_lost_state_leaves_its_turn_empty():
    with emulator(deployment(states=replace(SOUND, loss=1.0))) as there, Client(there) as client:
        assert [client.takes_turn(n) for n in (1, 2, 3)] == [[], [], []]
    assert there.robot.commands == 3 and there.server.answers == 0


def test_a_turn_that_comes_again_takes_no_time_and_is_answered_with_the_same():
    with emulator(deployment()) as there, Client(there) as client:
        assert [client.takes_turn(n) for n in (5, 6, 6, 6, 7)] == [[2000], [4000], [4000], [4000], [6000]]
    assert there.robot.commands == there.server.answers == 3 and there.robot.t == pytest.approx(0.006)


def test_a_turn_of_an_earlier_driver_is_not_heard_and_a_later_one_goes_on():
    with emulator(deployment()) as there, Client(there) as gone, Client(there) as client:
        assert gone.takes_turn(5) == [2000] and client.takes_turn(10**15) == [4000]
        gone.say(turn(6))
        assert client.takes_turn(10**15 + 1) == [6000]


def test_one_seed_repeats_the_fate_of_every_packet():
    bad = Wire(latency_s=0.004, jitter_s=0.006, loss=0.2, duplicate=0.2, corrupt=0.2, reorder=0.2)

    def fates(seed):
        with emulator(deployment(commands=bad, states=bad, seed=seed)) as there, Client(there) as client:
            return [client.answer_to(turn(n)) for n in range(1, 60)]

    assert fates(3) == fates(3) != fates(4)


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
