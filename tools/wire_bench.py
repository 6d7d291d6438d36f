"""How fast the real robot's driver is on this machine, spoken to by itself over 127.0.0.1."""

from __future__ import annotations

import socket
from collections.abc import Callable, Iterator, Sequence
from contextlib import closing, contextmanager
from dataclasses import replace
from threading import Event, Thread
from time import perf_counter, process_time, sleep, thread_time
from typing import Any

import numpy as np

from surefoot.bus.topics import CYCLE_HZ
from surefoot.config.deployment import Deployment
from surefoot.hw.aliengo.aliengo_state import AliengoState
from surefoot.hw.aliengo.command_packet import decode_command, encode_command
from surefoot.hw.aliengo.deadlines import Deadlines
from surefoot.hw.aliengo.driver import AliengoDriver
from surefoot.hw.aliengo.generation import GENERATIONS
from surefoot.hw.aliengo.plausibility import Plausibility
from surefoot.hw.aliengo.remote import Remote
from surefoot.hw.aliengo.state_packet import decode_state, encode_state
from surefoot.hw.robot_interface import MotorLaw

_REPEATS = 2000
_LAWS = 3  # at the least, however slow the machine is
_CYCLE_S = 1.0 / CYCLE_HZ
_ODD_S = (0.008, 0.012)  # between laws that come at any moment, drawn: evenly over two cycles


def wire_bench(seconds: float = 5.0) -> dict[str, Any]:
    """Measure the driver whose commands go by a timer.

    Args:
        seconds: of wall time, for what depends on it.

    Returns:
        `codec_us`: processor time of each encoder and decoder. Of laws written in every cycle: `jitter_ms`, median
        and p99 of how far the distances of commands are from 2 ms; `to_wire_ms`, median, p99 and maximum from
        `write` to the arrival at a socket of this machine; `cpu_share` of a core that the driver takes; `commands`
        that have come. `odd_to_wire_ms`: of laws written at any moment.
    """
    deployment = Deployment()
    return (
        {"codec_us": _codec(deployment)}
        | _in_every_cycle(deployment, seconds)
        | _at_odd_moments(deployment, seconds)
    )


def rows(found: dict[str, Any]) -> Iterator[tuple[str, str, str]]:
    """What was found, as rows `what, asked, got`."""
    jitter = found["jitter_ms"]
    yield "driver: commands off 2 ms, median, p99 [ms]", "", f"{jitter['p50']:6.3f} {jitter['p99']:6.3f}"
    for what, name in (("from write to the wire", "to_wire_ms"), ("at odd moments", "odd_to_wire_ms")):
        spread = "{p50:6.2f} {p99:6.2f} {max:6.2f}".format(**found[name])
        yield f"  {what}, median, p99, max [ms]", "", spread
    yield "  share of a core", "", f"{found['cpu_share']:6.3f}"
    yield "packets [us]", "", "  ".join(f"{name} {us:.0f}" for name, us in found["codec_us"].items())


def _codec(deployment: Deployment) -> dict[str, float]:
    wire, generation = deployment.hw.aliengo, GENERATIONS[deployment.hw.aliengo.generation]
    plausibility = Plausibility(deployment.load_robot(), wire.plausible)
    law, state = _law(0.0), _state()
    command = encode_command(law, generation, plausibility)[0]
    told = encode_state(state, generation, wire.reading)[0]
    work: dict[str, Callable[[], object]] = {
        "command": lambda: encode_command(law, generation, plausibility),
        "state": lambda: decode_state(told, generation, wire.reading, plausibility),
        "(robot's: command": lambda: decode_command(command, generation, plausibility),
        "state)": lambda: encode_state(state, generation, wire.reading),
    }
    return {name: _mean_us(each) for name, each in work.items()}


def _mean_us(work: Callable[[], object]) -> float:
    begun = process_time()
    for _ in range(_REPEATS):
        work()
    return 1e6 * (process_time() - begun) / _REPEATS


def _in_every_cycle(deployment: Deployment, seconds: float) -> dict[str, Any]:
    with _talk(deployment) as (driver, peer):
        first, cpu, peers, begun = len(peer.arrivals), process_time(), peer.cpu_s, perf_counter()
        deadlines = Deadlines(_CYCLE_S, begun)
        to_wire = _to_wire(driver, peer, seconds, lambda: deadlines.following(perf_counter())[0] - perf_counter())
        used, wall = process_time() - cpu - (peer.cpu_s - peers), perf_counter() - begun
        arrivals = np.array(peer.arrivals[first:])
    off = np.abs(np.diff(arrivals) - _CYCLE_S)
    return {
        "jitter_ms": _spread(off),
        "to_wire_ms": _spread(to_wire),
        "cpu_share": used / wall,
        "commands": len(arrivals),
    }


def _at_odd_moments(deployment: Deployment, seconds: float) -> dict[str, Any]:
    rng = np.random.default_rng(0)
    with _talk(deployment) as (driver, peer):
        return {"odd_to_wire_ms": _spread(_to_wire(driver, peer, seconds, lambda: rng.uniform(*_ODD_S)))}


@contextmanager
def _talk(deployment: Deployment) -> Iterator[tuple[AliengoDriver, _Peer]]:
    with closing(_Peer(deployment)) as peer:
        wire = replace(deployment.hw.aliengo, address="127.0.0.1", port=peer.port, local_port=0)
        with closing(AliengoDriver(deployment.load_robot(), wire, deployment.hw.damping_kd)) as driver:
            yield driver, peer


def _to_wire(driver: AliengoDriver, peer: _Peer, seconds: float, pause_s: Callable[[], float]) -> list[float]:
    """How long laws of different torques take to arrive [s], with pauses between them; those that do."""
    written: dict[int, float] = {}
    begun = perf_counter()
    while perf_counter() - begun < seconds or len(peer.first) < _LAWS:
        number = len(written) + 1
        law = _law(number / 256.0)
        written[number] = perf_counter()
        driver.write(law)
        driver.advance()
        sleep(max(pause_s(), 0.0))
    return [peer.first[number] - t for number, t in written.items() if number in peer.first]


def _spread(seconds: Sequence[float] | np.ndarray) -> dict[str, float]:
    """Median, p99 and maximum [ms]."""
    ms = 1e3 * np.asarray(seconds)
    return {"p50": float(np.median(ms)), "p99": float(np.percentile(ms, 99)), "max": float(ms.max())}


class _Peer:
    """Answers commands from a thread and notes when they come.

    Attributes:
        port: where it listens.
        arrivals: of all commands, on the performance counter [s].
        first: arrival of the first command of each law, by its number.
        cpu_s: processor time that this takes by itself.
    """

    def __init__(self, deployment: Deployment):
        wire, self._generation = deployment.hw.aliengo, GENERATIONS[deployment.hw.aliengo.generation]
        self._reading, self._plausibility = wire.reading, Plausibility(deployment.load_robot(), wire.plausible)
        self.arrivals: list[float] = []
        self.first: dict[int, float] = {}
        self.cpu_s = 0.0
        self._ended = Event()
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.bind(("127.0.0.1", 0))
        self._socket.settimeout(0.1)
        self.port: int = self._socket.getsockname()[1]
        self._thread = Thread(target=self._answer, daemon=True)
        self._thread.start()

    def close(self) -> None:
        self._ended.set()
        self._thread.join()
        self._socket.close()

    def _answer(self) -> None:
        state = _state()
        while not self._ended.is_set():
            try:
                packet, sender = self._socket.recvfrom(2048)
            except TimeoutError:
                continue
            arrived = perf_counter()
            self.arrivals.append(arrived)
            tick = round(2000 * len(self.arrivals))
            answer = encode_state(replace(state, tick=tick), self._generation, self._reading)[0]
            self._socket.sendto(answer, sender)
            law = decode_command(packet, self._generation, self._plausibility).law
            self.first.setdefault(round(256.0 * float(law.tau[0])), arrived)
            self.cpu_s = thread_time()


def _law(tau: float) -> MotorLaw:
    one = np.ones(12)
    return MotorLaw(q=0.0 * one, dq=0.0 * one, kp=0.0 * one, kd=one, tau=tau * one)


def _state() -> AliengoState:
    one = np.ones(12)
    return AliengoState(
        quat_WB=np.eye(4)[0],
        omega_WB_B=np.zeros(3),
        acc_B=np.array([0.0, 0.0, 9.81]),
        rpy=np.zeros(3),
        imu_temperature=25.0,
        mode=np.full(12, 10, np.uint8),
        q=np.tile([0.0, 0.7, -1.5], 4),
        dq=0.0 * one,
        ddq=0.0 * one,
        tau=0.0 * one,
        temperature=25.0 * one,
        foot_force=np.zeros(4),
        tick=0,
        remote=Remote(),
    )
