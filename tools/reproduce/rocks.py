"""Fig. 12: loose rocks, crossed blind."""

from __future__ import annotations

import numpy as np

from surefoot.tools.document import Part, Pictures, Words
from surefoot.tools.evaluation.one_run import LIMIT_S
from surefoot.tools.reproduce.experiment import Evidence, Experiment, Plan, crossing_table, cut_off, per_foothold
from surefoot.tools.reproduce.recorded_run import RecordedRun
from surefoot.tools.reproduce.run_spec import RunSpec
from surefoot.tools.reproduce.snapshots import Shot, whole_robot

SEEDS = (0, 1, 2)
SHOTS = 4


def specs(plan: Plan) -> list[RunSpec]:
    """Other stones for each seed."""
    limit_s = plan.settings.quick_limit_s if plan.quick else LIMIT_S
    return [RunSpec("rocks", "full", seed, limit_s, ("instants",)) for seed in plan.seeds_or(SEEDS)]


def along_the_way(trunk_x_m: np.ndarray, shots: int = SHOTS) -> list[int]:
    """Rows of instants at equal shares of the way the trunk has come, first and last among them."""
    places = np.linspace(trunk_x_m[0], trunk_x_m[-1], shots)
    return list(dict.fromkeys(int(np.abs(trunk_x_m - place).argmin()) for place in places))


def report(evidence: Evidence) -> list[Part]:
    """Snapshots of one crossing; success, time and candidates of all."""
    runs, quick = list(evidence.runs), evidence.plan.quick
    shown = next((run for run in runs if run.result["success"]), runs[0])
    times = [run.result["sim_time_s"] for run in runs if run.result["success"]]
    told = f"{len(times)} of {len(runs)} runs cross"
    if cut_off(runs, quick):
        told = "The quick version cuts the crossing off"
    elif times:
        told += f", in {np.mean(times):.0f} s on average"
    return [
        Words(f"{told}. Candidates tried for each foothold: {per_foothold(runs)}."),
        _snapshots(evidence, shown),
        crossing_table(runs, quick, "Loose rocks, blind."),
    ]


def _snapshots(evidence: Evidence, run: RecordedRun) -> Pictures:
    kept = run.arrays("instants")
    shots = []
    for number, row in enumerate(along_the_way(kept["trunk_x_m"]), 1):
        path = evidence.folder / f"rocks_{number}.jpg"
        shot = Shot(kept["qpos"][row], whole_robot(kept["qpos"][row][:3]), path)
        shots.append((shot, f"{kept['t'][row]:.0f} s"))
    return evidence.snapshots(run, shots, f"Snapshots, rendered from the run of seed {run.spec.seed}.")


EXPERIMENT = Experiment(
    "fig12_rocks",
    "Fig. 12 – Over loose rocks, blind",
    "The robot crosses loose rocks blind: it probes several positions until it finds a safe one and keeps itself "
    "balanced on the rocks throughout the path.",
    specs,
    report,
)
