"""Fig. 8: the tilting planks, crossed blind, and the baseline that does not cross them."""

from __future__ import annotations

import numpy as np

from surefoot.tools.document import Part, Pictures, Words
from surefoot.tools.evaluation.one_run import LIMIT_S
from surefoot.tools.reproduce.experiment import Evidence, Experiment, Plan, crossing_table, cut_off, verdict
from surefoot.tools.reproduce.recorded_run import RecordedRun
from surefoot.tools.reproduce.run_spec import RunSpec
from surefoot.tools.reproduce.snapshots import Shot, on_foot, whole_robot

SEEDS = (0, 1, 2, 3, 4)
PAPER_MEAN_S = 390.0
"""6.5 min, over five traversals (Sec. III-B.1)."""

_SEEN_FROM_OTHER_SIDE = 118.0
Instants = dict[str, np.ndarray]


def specs(plan: Plan) -> list[RunSpec]:
    """Each seed starts at another distance from the planks; the baseline from the same ones."""
    offsets = plan.settings.start_offsets_m
    limit_s = plan.settings.quick_limit_s if plan.quick else LIMIT_S
    usual = RunSpec("planks", "full", 0, limit_s, ()).deployment()
    found = []
    for arm in ("full", "mpc_only"):
        for place, seed in enumerate(plan.seeds_or(SEEDS)):
            offset = offsets[place % len(offsets)]
            goal = usual.fsm.goal_m + offset - usual.terrain.planks.start_offset_m  # as far beyond the planks
            overrides = (f"terrain.planks.start_offset_m={offset:g}", f"fsm.goal_m={goal:g}")
            found.append(RunSpec("planks", arm, seed, limit_s, ("instants",), overrides))
    return found


def report(evidence: Evidence) -> list[Part]:
    """(a) the traversal, (b) a point around a foothold that gave way, (c) the baseline, and the mean time."""
    arms, quick = evidence.arms, evidence.plan.quick
    full, baseline = arms.get("full", []), arms.get("mpc_only", [])
    parts: list[Part] = []
    if full:
        parts += [Words(mean_time(full, quick)), _traversal(evidence, full), _around(evidence, full)]
        caption = "The full framework, blind. Start: from the front feet to the first beam."
        parts.append(crossing_table(full, quick, caption, start=True))
    if baseline:
        parts.append(Words(f"The baseline, the MPC without probing, fails in {failures(baseline, quick)} runs."))
        parts.append(_baseline(evidence, baseline))
        parts.append(crossing_table(baseline, quick, "The baseline (arm mpc_only), blind.", start=True))
    return parts


def mean_time(runs: list[RecordedRun], quick: bool) -> str:
    """The mean of the complete traversals beside the paper's."""
    times = [run.result["sim_time_s"] for run in runs if run.result["success"]]
    paper = f"the paper's mean over five traversals is {PAPER_MEAN_S:.0f} s (6.5 min), on the robot"
    if not times:
        why = "the quick version cuts every crossing off" if cut_off(runs, quick) else "no run crossed"
        return f"No complete traversal here: {why}; {paper}."
    return (
        f"Mean of {len(times)} complete traversals ({len(runs)} started): {np.mean(times):.0f} s of simulated "
        f"time ({min(times):.0f} to {max(times):.0f} s); {paper}."
    )


def failures(runs: list[RecordedRun], quick: bool) -> str:
    """How many of the runs fail, in words; one that the quick version cuts off has not failed."""
    ends = [run.result["failure"] for run in runs if run.result["failure"] is not None]
    failed = [end for end in ends if not (quick and end == "timeout")]
    return f"{len(failed)} of {len(runs)}"


# (a) ----------------------------------------------------------------------------------------------------


def on_beam(foot_x: np.ndarray, run: RecordedRun) -> np.ndarray:
    """(n,) whether a foot's centre stands over one of the beams."""
    planks = run.spec.deployment().terrain.planks
    along = np.asarray(foot_x) - run.start_x
    over = (along % planks.pitch_m) <= planks.beam_width_m
    return over & (along >= 0.0) & (along < planks.rows * planks.pitch_m)


def traversal_rows(run: RecordedRun, kept: Instants) -> list[tuple[int, str, bool]]:
    """The paper's four snapshots, as far as the run has them.

    Returns:
        (row of the instants, label, whether the foot is looked at closely) of each.
    """
    kind, around = kept["kind"], kept["around"]
    found = []
    collapses = np.flatnonzero((kind == "collapse") & (around == 0))
    if len(collapses):
        moved_cm = 1e2 * kept["displacement_m"][collapses[0]]
        found.append((int(collapses[0]), f"the plank gives way under the probing foot ({moved_cm:.1f} cm)", True))
        up = np.flatnonzero((kind == "leg_up") & (np.arange(len(kind)) > collapses[0]))
        if len(up):
            found.append((int(up[0]), "the leg is taken away, the base stays", True))
    accepted = np.flatnonzero(kind == "accepted")
    beams = accepted[on_beam(kept["foot_W"][accepted, 0], run)] if len(accepted) else accepted
    if len(beams):
        found.append((int(beams[0]), "a foothold on a beam", True))
    on_planks = accepted[(kept["foot_W"][accepted, 0] > run.start_x) & (kept["foot_W"][accepted, 0] < run.end_x)]
    if len(on_planks) and (not len(beams) or on_planks[-1] != beams[0]):
        place = f"{1e2 * (run.end_x - kept['foot_W'][on_planks[-1], 0]):.0f} cm before their end"
        found.append((int(on_planks[-1]), f"the last foothold on the planks in this run, {place}", False))
    return found


def _traversal(evidence: Evidence, runs: list[RecordedRun]) -> Pictures:
    run = next((each for each in runs if each.result["success"]), runs[0])
    kept = run.arrays("instants")
    shots = []
    for number, (row, label, closely) in enumerate(traversal_rows(run, kept), 1):
        foot_W, leg = kept["foot_W"][row], int(kept["leg"][row])
        view = on_foot(foot_W, leg) if closely else whole_robot(kept["qpos"][row][:3])
        path = evidence.folder / f"traversal_{number}.jpg"
        shots.append((Shot(kept["qpos"][row], view, path), f"{number}: {label}, {kept['t'][row]:.1f} s"))
    caption = f"(a) Snapshots of the traversal, rendered from the run of seed {run.spec.seed}."
    return evidence.snapshots(run, shots, caption)


# (b) ----------------------------------------------------------------------------------------------------


def found_around(kept: Instants) -> int:
    """Row of the first collapse found around a foothold that had held, in front of it if there is one; -1 none."""
    kind, around = kept["kind"], kept["around"]
    for wanted in (around == 1, (around >= 1) & (around <= 4)):
        rows = np.flatnonzero((kind == "collapse") & wanted)
        if len(rows):
            return int(rows[0])
    return -1


def _around(evidence: Evidence, runs: list[RecordedRun]) -> Part:
    chosen: tuple[RecordedRun, Instants, int] | None = None
    for run in runs:
        kept = run.arrays("instants")
        row = found_around(kept)
        if row >= 0 and (chosen is None or (kept["around"][row] == 1 and chosen[1]["around"][chosen[2]] != 1)):
            chosen = run, kept, row
    if chosen is None:
        return Words(
            "(b) In these runs no point around a foothold gave way after the foothold itself had held: there is "
            "nothing to show of the paper's Fig. 8(b)."
        )
    run, kept, row = chosen
    point = ("", "in front of", "behind", "to the left of", "to the right of")[kept["around"][row]]
    view = on_foot(kept["foot_W"][row], int(kept["leg"][row]), distance_m=0.9)
    after = np.flatnonzero((kept["kind"] == "leg_up") & (np.arange(len(kept["kind"])) > row))
    shots = [(row, f"the point {point} a foothold that had held gives way, {kept['t'][row]:.1f} s")]
    if len(after):
        shots.append((int(after[0]), f"the foothold is given up, {kept['t'][after[0]]:.1f} s"))
    pictures = [
        (Shot(kept["qpos"][each], view, evidence.folder / f"around_{number}.jpg"), label)
        for number, (each, label) in enumerate(shots, 1)
    ]
    caption = f"(b) Probing around keeps the foot from the edge (seed {run.spec.seed})."
    return evidence.snapshots(run, pictures, caption)


# (c) ----------------------------------------------------------------------------------------------------


def _baseline(evidence: Evidence, runs: list[RecordedRun]) -> Pictures:
    run = next((each for each in runs if not each.result["success"]), runs[0])
    kept = run.arrays("instants")
    end = kept["qpos"][-1]
    label = f"seed {run.spec.seed}: {verdict(run, evidence.plan.quick)} after {kept['t'][-1]:.1f} s"
    shots = [
        (Shot(end, whole_robot(end[:3]), evidence.folder / "baseline_right.jpg"), label),
        (
            Shot(end, whole_robot(end[:3], -_SEEN_FROM_OTHER_SIDE), evidence.folder / "baseline_left.jpg"),
            "the same from its left, ahead",
        ),
    ]
    return evidence.snapshots(run, shots, "(c) The baseline at its end.")


EXPERIMENT = Experiment(
    "fig08_planks",
    "Fig. 8 – Across the tilting planks, blind",
    "The robot crosses the planks blind and with the map in 6.5 minutes on average over five traversals from "
    "different starts. It finds most safe footholds on the beams; probing around a foothold keeps the foot from "
    "an edge; the MPC alone, without probing, fails with its legs trapped under the planks.",
    specs,
    report,
)
