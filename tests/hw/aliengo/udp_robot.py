"""A robot on 127.0.0.1 that answers over UDP when it is spoken to."""

import socket
from dataclasses import replace
from threading import Condition, Event, Thread

import numpy as np
from packet_samples import PLAUSIBILITY, READING, drawn_state

from surefoot.hw.aliengo.command_packet import AliengoCommand, decode_command
from surefoot.hw.aliengo.generation import G1
from surefoot.hw.aliengo.state_packet import encode_state
from surefoot.hw.aliengo.turn import Turn, decode_turn, encode_turn

PATIENCE_S = 60.0
"""Until a test is given up; none depends on how soon something happens."""


def one_state(robot):
    """The answer of a sound robot: its state, a cycle later."""
    robot.tick += 2000
    return [robot.packet()]


class UdpRobot:
    """Answers every command from the socket on which it came, and a turn with a turn.

    Attributes:
        port: where it listens, an ephemeral one.
        commands: all that it was asked, in order.
        state: what it tells; the tick is its own.
        tick: counted up by what answers.
    """

    def __init__(self, generation=G1, answer=one_state):
        """`answer`: makes a command's answers of this robot, a list of packets."""
        self.generation, self.answer = generation, answer
        self.state = drawn_state(np.random.default_rng(11))
        self.tick = 0
        self.commands: list[AliengoCommand] = []
        self._heard = Condition()
        self._ending = Event()
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.bind(("127.0.0.1", 0))
        self._socket.settimeout(0.05)
        self.port = self._socket.getsockname()[1]
        self._thread = Thread(target=self._serve, daemon=True)
        self._thread.start()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._ending.set()
        self._thread.join()
        self._socket.close()

    def packet(self):
        return encode_state(replace(self.state, tick=self.tick % 2**32), self.generation, READING)[0]

    def hears(self, is_awaited):
        """Wait until a command is of a kind; answers which it was."""

        def newest():
            return bool(self.commands) and is_awaited(self.commands[-1])

        with self._heard:
            assert self._heard.wait_for(newest, PATIENCE_S), "no such command came"
            return self.commands[-1]

    def hears_next_of(self, driver):
        """The command after the one that a driver may just be sending: it is made up from here on."""
        number = driver.statistics.commands + 1
        with self._heard:
            assert self._heard.wait_for(lambda: len(self.commands) > number, PATIENCE_S), "silence"
            return self.commands[number]

    def hears_more(self, number):
        """Wait for a number of further commands; answers them."""
        with self._heard:
            begin = len(self.commands)
            assert self._heard.wait_for(lambda: len(self.commands) >= begin + number, PATIENCE_S), "silence"
            return self.commands[begin:]

    def _serve(self):
        while not self._ending.is_set():
            try:
                packet, sender = self._socket.recvfrom(2048)
            except TimeoutError:
                continue
            turn = decode_turn(packet)
            for asked in (packet,) if turn is None else turn.packets:
                command = decode_command(asked, self.generation, PLAUSIBILITY)
                with self._heard:
                    self.commands.append(command)
                    self._heard.notify_all()
            answers = self.answer(self)
            for answer in answers if turn is None else [encode_turn(Turn(turn.number, tuple(answers)))]:
                self._socket.sendto(answer, sender)


def damps(command):
    """Whether a command is the safe state of these tests: velocity gains alone."""
    law = command.law
    return (law.kd == 3.0).all() and not law.kp.any() and not law.tau.any() and not law.dq.any()
