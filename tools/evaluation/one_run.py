"""One graded run of the whole stack in lockstep."""

from __future__ import annotations

import os
import traceback
from collections.abc import Callable, Sequence
from pathlib import Path
from time import perf_counter
from typing import cast

import numpy as np

from surefoot.components.io.io import Io
from surefoot.components.lockstep import Listener, Lockstep
from surefoot.config.deployment import Deployment
from surefoot.hw.mujoco.backend import MujocoRobot
from surefoot.tools.evaluation.grader import Grader
from surefoot.tools.evaluation.true_state import TrueState
from surefoot.tools.recording.lockstep_recording import LockstepRecording
from surefoot.tools.stopwatch import Stopwatch

LIMIT_S = 1200.0
"""Simulated time after which a run is a failure."""

_PROGRESS_S = 10.0


Progress = Callable[[str], None]
"""Told now and then, in a line, how a run goes."""


def grade(
    deployment: Deployment,
    limit_s: float = LIMIT_S,
    progress: Progress | None = None,
    true_state: bool = False,
    listeners: Sequence[Listener] = (),
    record: Path | None = None,
) -> dict:
    """Run a deployment until it is decided; a crash is reported as the run's failure.

    Args:
        deployment: what is run.
        limit_s: simulated time that counts as a time-out.
        progress: is told how it goes.
        true_state: the estimator is ideal.
        listeners: hear every message of the run.
        record: file for a recording of it.

    Returns:
        One entry of `runs` in `results.json`.
    """
    seed = deployment.hw.seed
    try:
        return {"seed": seed} | _grade(deployment, limit_s, progress, true_state, listeners, record)
    except Exception as error:  # one run's crash must not take the others with it
        where = traceback.extract_tb(error.__traceback__)[-1]
        reason = f"error: {type(error).__name__}: {error} ({os.path.basename(where.filename)}:{where.lineno})"
        return {"seed": seed, "success": False, "failure": reason}


def _grade(
    deployment: Deployment,
    limit_s: float,
    progress: Progress | None,
    true_state: bool,
    listeners: Sequence[Listener],
    record: Path | None,
) -> dict:
    stack = Lockstep(deployment, given=[TrueState(deployment)] if true_state else [])
    recording = LockstepRecording(stack, deployment, record) if record is not None else None
    io = cast(Io, stack.components["io"])  # what the registry has under this name
    robot = cast(MujocoRobot, io.robot)  # only what knows the truth can be graded: `evaluate` refuses others
    grader = Grader(deployment, robot.field)
    watches = {name: Stopwatch(component, "step") for name, component in stack.components.items()}
    watches["physics"] = Stopwatch(robot, "advance")
    stack.listen(grader)
    for listener in listeners:
        stack.listen(listener)
    stack.command(deployment.run.command)
    begun, told = perf_counter(), 0.0

    def decided() -> bool:
        nonlocal told
        if progress is not None and stack.t - told >= _PROGRESS_S:
            told = stack.t
            done = grader.counts
            progress(f"{stack.t:.0f} s, {done['footholds']} footholds, {done['collapses_detected']} collapses")
        return grader.outcome.over

    stack.run(limit_s, decided)
    if recording is not None:
        recording.close()
    wall = perf_counter() - begun
    grader.outcome.finish(stack.t, limit_s)
    return {
        "sim_time_s": stack.t,
        "wall_time_s": wall,
        "real_time_factor": stack.t / wall,
        **grader.results(),
        "timing_ms": {name: _percentiles(watch.ms) for name, watch in watches.items() if watch.ms},
    }


def _percentiles(values: Sequence[float]) -> dict[str, float]:
    p50, p99 = np.percentile(values, [50, 99]).tolist()
    return {"p50": p50, "p99": p99, "max": max(values)}
