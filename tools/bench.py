"""How fast the stack is on this machine, beside what is asked of it.

Nothing of it is a timed test: no test and no exit code depends on a figure, since they tell as much of what
else the machine does as of the code. Compare figures of one machine, or after division by the calibration.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter

import numpy as np

from surefoot.bus.message import Message
from surefoot.bus.messages import DepthFrame, MotionReference, PlanRequest, Policy, StateEstimate
from surefoot.components.component import Inbox, Outbox
from surefoot.components.elevation_map.elevation_map import ElevationMap
from surefoot.components.lockstep import Lockstep
from surefoot.components.trajopt.trajopt import Trajopt
from surefoot.config.deployment import Deployment, Run
from surefoot.config.terrain import Terrain
from surefoot.hw.mujoco.backend import MujocoRobot
from surefoot.hw.robot_interface import MotorLaw
from surefoot.tools import wire_bench
from surefoot.tools.bus_bench import bus_bench, rows
from surefoot.tools.stopwatch import Stopwatch

WARM_UP_S = 4.0
"""Simulated time until the robot stands and every component is at work."""

WALK_S = 12.0
"""Simulated time that is measured: more than one foothold, with its swing and its probing."""

TRAJOPT_SOLVES = 24
IMAGES = 60

# (row, figure, at most).
_ASKED = (
    ("mpc tick, median [ms]", lambda found: found["step_ms"]["mpc"]["p50"], 5.0),
    ("mpc tick, p99 [ms]", lambda found: found["step_ms"]["mpc"]["p99"], 10.0),
    ("trajopt, mean [ms]", lambda found: found["trajopt_ms"]["mean"], 100.0),
    ("wbc tick, median [ms]", lambda found: found["step_ms"]["wbc"]["p50"], 0.8),
    ("elevation map, frame to map, median [ms]", lambda found: found["map_ms"]["p50"], 20.0),
)
_REAL_TIME_FACTOR = 0.6


def bench(say: Callable[[str], None] = print) -> dict:
    """Measure and print a table `what | asked | got`; takes about ten minutes.

    Returns:
        `calibration_ms`; `step_ms`: median, p99 and maximum for each component; `mpc_stage_ms`: the same for
        each stage of an mpc tick; `trajopt_ms`: mean, median, maximum and number of solves; `image_ms` of the
        simulated depth camera and `map_ms` from an image to the map with it: median, p99 and maximum;
        `real_time_factor` of the whole stack; `references`: how many had a leg swing and how many one probe;
        `bus` as of `bus_bench`; `wire` as of `wire_bench`; `view` as of `view_bench`, empty without its package.
    """
    found: dict = {"calibration_ms": calibration_ms()}
    witness = _Witness()
    found |= _walk(witness)
    found["trajopt_ms"] = _trajopt(witness)
    found |= _sight()
    found["bus"] = bus_bench()
    found["wire"] = wire_bench.wire_bench()
    found["view"] = _view()
    _tell(found, say)
    return found


def calibration_ms(repeats: int = 7) -> float:
    """Best wall time of a fixed mixture of interpreted Python, small numpy calls and small matrix products."""
    rng = np.random.default_rng(0)
    small, stage = rng.normal(size=(67, 4, 3, 3)), rng.normal(size=(37, 37))

    def work() -> float:
        total = 0.0
        for n in range(400):
            product = small @ small
            product *= 0.5
            total += float((stage @ stage)[0, 0]) + sum(i * 0.5 for i in range(100)) + n
        return total

    times = []
    for _ in range(repeats):
        begun = perf_counter()
        work()
        times.append(1e3 * (perf_counter() - begun))
    return min(times)


class _Witness:
    """Keeps of the bus what the figures need."""

    def __init__(self) -> None:
        self.stages: dict[str, list[float]] = {}
        self.swinging = self.probing = 0
        self.request: Message | None = None
        self.estimate: Message | None = None
        self._last_estimate: Message | None = None

    def __call__(self, key: str, message: Message) -> None:
        if isinstance(message, Policy) and message.valid:
            for stage, ms in zip(message.stage, message.stage_ms.tolist(), strict=True):
                self.stages.setdefault(stage, []).append(ms)
        elif isinstance(message, MotionReference):
            self.swinging += message.swing_leg >= 0
            self.probing += message.probe_leg >= 0
        elif isinstance(message, StateEstimate):
            self._last_estimate = message
        elif isinstance(message, PlanRequest):
            self.request, self.estimate = message, self._last_estimate


def _walk(witness: _Witness) -> dict:
    """Walk over flat ground in lockstep."""
    stack = Lockstep(Deployment())
    stack.command("forward")
    stack.run(WARM_UP_S)
    watches = {name: Stopwatch(component, "step") for name, component in stack.components.items()}
    stack.listen(witness)
    begun = perf_counter()
    stack.run(WARM_UP_S + WALK_S)
    wall = perf_counter() - begun
    return {
        "step_ms": {name: _spread(watch.ms) for name, watch in watches.items() if watch.ms},
        "mpc_stage_ms": {stage: _spread(times) for stage, times in witness.stages.items()},
        "real_time_factor": WALK_S / wall,
        "references": {"swing": int(witness.swinging), "probe": int(witness.probing)},
    }


def _trajopt(witness: _Witness) -> dict:
    """The walk's last request, solved anew again and again."""
    if witness.request is None or witness.estimate is None:
        raise RuntimeError(f"bench: no trajopt/request within {WALK_S} s of walking; does the robot walk?")
    component = Trajopt(Deployment())
    component.warm_up()
    inbox, times = Inbox(component.inputs), []
    outbox = Outbox(component.outputs, lambda key, message: None)
    inbox.deliver("state/estimate", witness.estimate)
    for _ in range(TRAJOPT_SOLVES + 1):
        inbox.deliver("trajopt/request", witness.request)
        begun = perf_counter()
        component.step(witness.estimate.t, inbox, outbox)
        times.append(1e3 * (perf_counter() - begun))
        inbox.clear_new()
    return _spread(times[1:]) | {"mean": float(np.mean(times[1:])), "solves": TRAJOPT_SOLVES}


def _sight() -> dict:
    """A robot that stands before the planks and looks at them; its map knows where it is."""
    deployment = Deployment(run=Run(vision=True), terrain=Terrain(kind="planks"))
    machine, component = MujocoRobot(deployment), ElevationMap(deployment)
    inbox, outbox = Inbox(component.inputs), Outbox(component.outputs, lambda key, message: None)
    zero = np.zeros(12)
    stand_q = np.tile(deployment.load_robot().nominal.stand_q, 4)
    hold = MotorLaw(q=stand_q, dq=zero, kp=np.full(12, 300.0), kd=np.full(12, 8.0), tau=zero)
    image_ms: list[float] = []
    map_ms: list[float] = []
    while len(map_ms) <= IMAGES:
        begun = perf_counter()
        image = machine.depth()
        if image is not None:
            image_ms.append(1e3 * (perf_counter() - begun))
            truth = machine.truth()
            frame = DepthFrame(
                t=truth.t, valid=True, p_BC=image.p_BC, quat_BC=image.quat_BC, fov=image.fov, depth_m=image.depth_m
            )
            inbox.deliver(
                "state/estimate", StateEstimate(t=truth.t, valid=True, p_WB=truth.p_WB, quat_WB=truth.quat_WB)
            )
            inbox.deliver("hw/depth", frame)
            begun = perf_counter()
            component.step(truth.t, inbox, outbox)
            map_ms.append(1e3 * (perf_counter() - begun))
            inbox.clear_new()
        machine.write(hold)
        machine.advance()
    return {"image_ms": _spread(image_ms[1:]), "map_ms": _spread(map_ms[1:])}


def _view() -> dict:
    """What the view in a browser costs; nothing where its package is missing."""
    try:
        from surefoot.tools.view import view_bench
    except ModuleNotFoundError:
        return {}
    with TemporaryDirectory(prefix="surefoot-bench-") as folder:
        return view_bench.view_bench(Path(folder))


def _spread(times: Iterable[float]) -> dict[str, float]:
    times = np.asarray(times)
    return {"p50": float(np.median(times)), "p99": float(np.percentile(times, 99)), "max": float(times.max())}


def _tell(found: dict, say: Callable[[str], None]) -> None:
    def row(what: str, asked: str, got: str) -> None:
        say(f"{what:42} | {asked:>8} | {got}")

    def spread(times: dict[str, float]) -> str:
        return f"{times['p50']:6.2f} {times['p99']:6.2f} {times['max']:6.2f}"

    row("what", "asked", "got")
    for what, figure, limit in _ASKED:
        got = figure(found)
        row(what, f"<= {limit:g}", f"{got:6.2f}{'' if got <= limit else '  missed'}")
    factor = found["real_time_factor"]
    missed = "" if factor >= _REAL_TIME_FACTOR else "  missed"
    row("lockstep real-time factor", f">= {_REAL_TIME_FACTOR:g}", f"{factor:6.2f}{missed}")
    row("calibration [ms]", "", f"{found['calibration_ms']:6.2f}")
    for of_bus in rows(found["bus"], factor):
        row(*of_bus)
    for of_wire in wire_bench.rows(found["wire"]):
        row(*of_wire)
    if found["view"]:
        from surefoot.tools.view import view_bench

        for of_view in view_bench.rows(found["view"]):
            row(*of_view)
    row("median, p99, max of a tick [ms]", "", "")
    for name, times in found["step_ms"].items():
        row(f"  {name}", "", spread(times))
    row("  image of the depth camera, planks", "", spread(found["image_ms"]))
    row("  elevation map, image to map", "", spread(found["map_ms"]))
    row("stages of an mpc tick [ms]", "", "")
    for stage, times in found["mpc_stage_ms"].items():
        row(f"  {stage}", "", spread(times))
    say(
        f"Over {WALK_S:g} simulated s of walking on flat ground; {found['references']['swing']} references with a "
        f"swing, {found['references']['probe']} with probing; {found['trajopt_ms']['solves']} solves of trajopt. "
        "None of this is a timed test."
    )
