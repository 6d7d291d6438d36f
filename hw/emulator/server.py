"""The emulated robot on a UDP port."""

from __future__ import annotations

import select
import socket
from collections.abc import Callable, Sequence
from contextlib import suppress
from time import monotonic

from surefoot.config.deployment import Deployment
from surefoot.hw.emulator.emulated_robot import CYCLE_S, EmulatedRobot
from surefoot.hw.emulator.link_faults import LinkFaults, Packet
from surefoot.hw.errors import HardwareFault
from surefoot.hw.mujoco.plant import stream

_LONGEST = 2048  # more than any packet, so that a longer one shows
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
        """Each packet that comes, and be it lost on the rest of its way, takes a cycle of the robot's time.

        What the link would deliver within a cycle is delivered at once: nobody else lets time go on.
        """
        while not ended():
            for packet in self._receive(_LOOK_S):
                self._commands.send(packet, self.robot.t)
                asked = self._take_commands(self.robot.t + CYCLE_S)
                self.robot.advance()
                self._answer(asked, self.robot.t)
                self._deliver(self.robot.t + CYCLE_S)

    def _follow_wall(self, ended: Callable[[], bool]) -> None:
        """The robot's time is the wall's; a late cycle is made up, so that the tick keeps its pace."""
        begin = monotonic()
        while not ended():
            due = min(self.robot.t + CYCLE_S, self._commands.next_t, self._states.next_t)
            for packet in self._receive(due - (monotonic() - begin)):
                self._commands.send(packet, monotonic() - begin)
            now = monotonic() - begin
            self._answer(self._take_commands(now), now)
            self._deliver(now)
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

    def _deliver(self, t: float) -> None:
        for packet in self._states.due(t):
            self.answers += 1
            with suppress(OSError):  # who asked may be out of reach by now
                self._socket.sendto(*packet)
