"""The emulated robot on a UDP port."""

from __future__ import annotations

import select
import socket
from collections.abc import Callable, Sequence
from contextlib import suppress
from time import monotonic

from surefoot.config.deployment import Deployment
from surefoot.hw.aliengo.turn import Turn, decode_turn, encode_turn
from surefoot.hw.emulator.emulated_robot import CYCLE_S, EmulatedRobot
from surefoot.hw.emulator.link_faults import LinkFaults, Packet
from surefoot.hw.errors import HardwareFault
from surefoot.hw.mujoco.plant import stream

_LONGEST = 65535  # more than a datagram has room for: one that is too long shows
_LOOK_S = 0.1
_AT_ONCE = 10  # cycles that are made up before the socket is looked at again
_TOO_LATE_S = 0.2  # what this machine lags behind beyond it is given up


class EmulatorServer:
    """Speaks when spoken to, from the socket that it was spoken to on.

    Attributes:
        robot: who answers.
        port: where.
        answers: how many have left.
        lag_s: how much of the wall's time the robot's has not followed; this machine is too slow for it.
    """

    def __init__(self, deployment: Deployment, port: int | None = None):
        """Open the port; nothing is answered yet.

        Args:
            deployment: robot, ground and settings.
            port: instead of `hw.aliengo.port`; 0: any that is free.

        Raises:
            HardwareFault: the port is taken.
        """
        self._settings, seed = deployment.emulator, deployment.hw.seed
        wanted = deployment.hw.aliengo.port if port is None else port
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.setblocking(False)
        try:
            self._socket.bind((self._settings.listen, wanted))
        except OSError as error:
            self._socket.close()
            raise HardwareFault(
                f"UDP port {wanted} at {self._settings.listen}: {error.strerror}; does another emulator run? give "
                "--port, and check emulator.listen"
            ) from None
        self.port: int = self._socket.getsockname()[1]
        self.robot = EmulatedRobot(deployment)
        self._commands = LinkFaults(self._settings.commands, stream(seed, "link_commands"))
        self._states = LinkFaults(self._settings.states, stream(seed, "link_states"))
        self._turn = Turn(-1, ())
        self.answers = 0
        self.lag_s = 0.0

    def serve(self, ended: Callable[[], bool]) -> None:
        """Until `ended()`; then the port is closed.

        Raises:
            HardwareFault: the physics diverged.
        """
        with self._socket:
            if self._settings.pace == "packets":
                self._follow_packets(ended)
            else:
                self._follow_wall(ended)

    def _follow_packets(self, ended: Callable[[], bool]) -> None:
        """Each packet takes a cycle of the robot's time, at whose beginning it has left; so does each new turn."""
        while not ended():
            for packet in self._receive(_LOOK_S):
                turn = decode_turn(packet.data)
                if turn is None:
                    self._send(self._cycle([packet]))
                else:
                    self._take_turn(turn, packet.peer)

    def _take_turn(self, turn: Turn, peer: tuple[str, int]) -> None:
        """Answer a turn; one that comes again, because it or its answer got lost, is answered with the same."""
        if turn.number < self._turn.number:
            return  # of a driver that is gone, or has gone on
        if turn.number > self._turn.number:
            arrived = self._cycle([Packet(data, peer) for data in turn.packets])
            self._turn = Turn(turn.number, tuple(packet.data for packet in arrived if packet.peer == peer))
            self.answers += len(self._turn.packets)
        with suppress(OSError):  # who asked may be out of reach by now
            self._socket.sendto(encode_turn(self._turn), peer)

    def _cycle(self, packets: Sequence[Packet]) -> list[Packet]:
        """Go on by a cycle, at whose beginning commands have left; the states that have arrived by its end.

        The link's delays are of the robot's time. A command acts from the first physics step on at which it has
        arrived, and is answered at the end of the cycle in which that is, with what is measured there. Whoever
        reads between two cycles finds what has arrived by then: a state is as old as its way is long, in whole
        cycles.
        """
        robot, asked = self.robot, []
        for packet in packets:
            self._commands.send(packet, robot.t)
        robot.advance(lambda t: asked.extend(self._take_commands(t)))
        self._answer(asked, robot.t)
        return self._states.due(robot.t)

    def _follow_wall(self, ended: Callable[[], bool]) -> None:
        """The robot's time is the wall's; a late cycle is made up, so that the tick keeps its pace."""
        begin = monotonic()
        while not ended():
            due = min(self.robot.t + CYCLE_S, self._commands.next_t, self._states.next_t)
            for packet in self._receive(due - (monotonic() - begin)):
                self._commands.send(packet, monotonic() - begin)
            now = monotonic() - begin
            self._answer(self._take_commands(now), now)
            self._send(self._states.due(now))
            late_s = now - self.robot.t
            for _ in range(min(int(late_s / CYCLE_S), _AT_ONCE)):
                self.robot.advance()
            if late_s > _TOO_LATE_S:
                begin += late_s
                self.lag_s += late_s

    def _receive(self, seconds: float) -> list[Packet]:
        """What has come, after waiting for it so long at the most."""
        if not select.select([self._socket], [], [], max(seconds, 0.0))[0]:
            return []
        packets = []
        for _ in range(_AT_ONCE):
            try:
                packets.append(Packet(*self._socket.recvfrom(_LONGEST)))
            except BlockingIOError:
                break
        return packets

    def _take_commands(self, t: float) -> list[tuple[str, int]]:
        """Commands that have arrived by time `t` [s]; who is to be answered."""
        return [packet.peer for packet in self._commands.due(t) if self.robot.take(packet.data)]

    def _answer(self, peers: Sequence[tuple[str, int]], t: float) -> None:
        for peer in peers:
            answer = self.robot.answer()
            if answer is not None:
                self._states.send(Packet(answer, peer), t)

    def _send(self, packets: Sequence[Packet]) -> None:
        for packet in packets:
            self.answers += 1
            with suppress(OSError):  # who asked may be out of reach by now
                self._socket.sendto(*packet)
