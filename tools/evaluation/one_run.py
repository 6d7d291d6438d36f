"""One graded run of the whole stack in lockstep."""

from __future__ import annotations

import os
import traceback
from collections.abc import Callable
from time import perf_counter
from typing import cast

import numpy as np

from surefoot.components.io.io import Io
from surefoot.components.lockstep import Lockstep
from surefoot.config.deployment import Deployment
from surefoot.tools.evaluation.grader import Grader

LIMIT_S = 1200.0
"""Simulated time after which a run is a failure."""

_PROGRESS_S = 10.0


def grade(deployment: Deployment, limit_s: float = LIMIT_S, progress: Callable[[str], None] | None = None) -> dict:
    """Run a deployment until it is decided; a crash is reported as the run's failure.

    Returns:
        One entry of `runs` in `results.json`.
    """
    seed = deployment.hw.seed
    try:
        return {"seed": seed} | _grade(deployment, limit_s, progress)
    except Exception as error:  # one run's crash must not take the others with it
        where = traceback.extract_tb(error.__traceback__)[-1]
        reason = f"error: {type(error).__name__}: {error} ({os.path.basename(where.filename)}:{where.lineno})"
        return {"seed": seed, "success": False, "failure": reason}


def _grade(deployment: Deployment, limit_s: float, progress: Callable[[str], None] | None) -> dict:
    stack = Lockstep(deployment)
    io = cast(Io, stack.components["io"])  # what the registry has under this name
    grader = Grader(deployment, io.robot.field.end_x)
    stack.listen(grader)
    stack.command(deployment.run.command)
    begun, told = perf_counter(), 0.0

    def decided() -> bool:
        nonlocal told
        if progress is not None and stack.t - told >= _PROGRESS_S:
            told = stack.t
            done = grader.counts
            progress(f"{stack.t:.0f} s, {done['footholds']} footholds, {done['collapses_detected']} collapses")
        return grader.over

    stack.run(limit_s, decided)
    wall = perf_counter() - begun
    grader.finish(stack.t, limit_s)
    timing = {
        name: {
            "p50": float(np.percentile(executor.step_ms, 50)),
            "p99": float(np.percentile(executor.step_ms, 99)),
            "max": float(np.max(executor.step_ms)),
        }
        for name, executor in stack.executors.items()
        if executor.step_ms
    }
    return {
        "sim_time_s": stack.t,
        "wall_time_s": wall,
        "real_time_factor": stack.t / wall,
        **grader.results(),
        "timing_ms": timing,
    }
