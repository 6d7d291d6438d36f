"""Fig. 10: what the envelope asks, the MPC plans, the joint torques tell and the ground feels."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from surefoot.config.robot import LEGS
from surefoot.tools.document import Part, Pictures, Table, Words
from surefoot.tools.reproduce.experiment import Evidence, Experiment, Plan
from surefoot.tools.reproduce.plots import Figure, force_panel, new_figure, normal_component, rmse, save, styled
from surefoot.tools.reproduce.recording.forces import FORCES
from surefoot.tools.reproduce.run_spec import RunSpec

SEEDS = (0, 1, 2)
_SHOWN = 4  # probes in the figure: each leg once


def specs(plan: Plan) -> list[RunSpec]:
    """Flat, rigid ground with everything on, as on the robot."""
    goal = plan.settings.quick_goal_m if plan.quick else plan.settings.flat_goal_m
    return [
        RunSpec("flat", "full", seed, 1200.0, ("forces",), (f"fsm.goal_m={goal}",))
        for seed in plan.seeds_or(SEEDS)
    ]


def probes_of(series: dict[str, np.ndarray]) -> list[np.ndarray]:
    """Rows of each probe of a foothold itself while it presses, in order."""
    rows = series["pressing"] & (series["around"] == 0)
    return [np.flatnonzero(rows & (series["probe"] == probe)) for probe in np.unique(series["probe"][rows])]


def components(series: dict[str, np.ndarray], rows: np.ndarray, names: Sequence[str]) -> list[dict]:
    """For normal, x and y: the named forces over those rows (n,) [N]."""
    normal = {name: normal_component(series[name][rows], series["normal_W"][rows]) for name in names}
    return [normal, *({name: series[name][rows, axis] for name in names} for axis in (0, 1))]


def errors(series: dict[str, np.ndarray]) -> dict[str, float]:
    """RMSE of normal components while a force is asked, blends between forces included [N]."""
    rows = series["pressing"] & np.isfinite(series["asked"]).all(axis=1)
    normal = {name: normal_component(series[name][rows], series["normal_W"][rows]) for name in FORCES}
    pairs = (("mpc", "asked"), ("true", "mpc"), ("estimated", "true"), ("estimated", "mpc"))
    return {f"{first} / {second}": rmse(normal[first], normal[second]) for first, second in pairs}


def tracking(columns: Sequence[tuple[str, dict[str, np.ndarray], np.ndarray]]) -> Figure:
    """Normal, x and y over the time from contact, a column for each probe: its name, series, and rows of that."""
    figure = new_figure(max(3.0 * len(columns) + 0.4, 5.6), 6.2)
    grid = figure.subplots(3, len(columns), squeeze=False, sharey="row")
    for number, (name, series, rows) in enumerate(columns):
        t = series["t"][rows] - series["t"][rows[0]]
        parts = components(series, rows, ("true", "asked", "mpc", "estimated"))
        for axes, values, title in zip(grid[:, number], parts, (f"{name}, normal", "x", "y"), strict=True):
            force_panel(axes, t, values, title)
    handles, labels = grid[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper center", ncols=min(2 * len(columns), 4))
    return figure


def report(evidence: Evidence) -> list[Part]:
    """The first probe of each leg, and the differences over all of them."""
    series = [run.arrays("forces") for run in evidence.runs]
    rows = []
    for run, each in zip(evidence.runs, series, strict=True):
        told, held = errors(each), run.result["probe_rmse_n"]
        rows.append(
            [str(run.spec.seed), str(run.result["probes"]), *(f"{value:.1f}" for value in told.values())]
            + [f"{held['true_vs_mpc']:.1f}", f"{held['estimate_vs_true']:.1f}"]
        )
    head = ["seed", "probes", "MPC − asked", "true − MPC", "estimated − true", "estimated − MPC"]
    head += ["held: true − MPC", "held: estimated − true"]
    table = Table(
        "RMSE of the normal force while a force of the envelope is asked [N]. The last two columns take the "
        "second half of each 100 ms only, when the change from one force to the next is over.",
        head,
        rows,
    )
    first = series[0]
    probes = probes_of(first)[:_SHOWN]
    if not probes:
        return [Words("No probe was reached in this run."), table]
    with styled():
        columns = [(LEGS[first["leg"][shown[0]]], first, shown) for shown in probes]
        path = save(tracking(columns), evidence.folder / "forces.svg")
    caption = (
        f"Seed {evidence.runs[0].spec.seed}: the first probe of each leg. Time from contact; six forces of 100 ms "
        "follow the 0.12 s in which the base leans towards the foot, then the foot is unloaded."
    )
    return [Pictures(caption, [path], ["Forces over time while probing"]), table]


EXPERIMENT = Experiment(
    "fig10_force_tracking",
    "Fig. 10 – The force that was asked for really acts",
    "The whole-body controller tracks the contact forces of the MPC: the force from the joint torques follows the "
    "MPC's, which stays somewhat below the envelope.",
    specs,
    report,
)
