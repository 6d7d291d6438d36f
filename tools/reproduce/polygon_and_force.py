"""Fig. 9: the support polygon against the probing force, on ground that does not collapse."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from surefoot.config.robot import LEGS
from surefoot.tools.document import Part, Pictures, Table, Words
from surefoot.tools.evaluation.grader import ENVELOPE_FORCES
from surefoot.tools.reproduce.experiment import Evidence, Experiment, Plan
from surefoot.tools.reproduce.force_tracking import components, errors, probes_of
from surefoot.tools.reproduce.plots import Axes, force_panel, new_figure, polygon_panel, save, styled
from surefoot.tools.reproduce.recorded_run import RecordedRun
from surefoot.tools.reproduce.run_spec import RunSpec

SEEDS = (0, 1, 2)
ARMS = {"no_support_polygon": "without (5)", "full": "with (5)"}
"""Top and bottom row of the figure."""


def specs(plan: Plan) -> list[RunSpec]:
    """The base follows the paper's plain stride reference, so that only eq. (5) keeps the CoM inside."""
    goal = plan.settings.quick_goal_m if plan.quick else plan.settings.flat_goal_m
    overrides = ("fsm.base_reference=stride", "fsm.probe_around=false", f"fsm.goal_m={goal}")
    return [
        RunSpec("flat", arm, seed, 1200.0, ("forces",), overrides) for arm in ARMS for seed in plan.seeds_or(SEEDS)
    ]


def margins(series: dict[str, np.ndarray]) -> list[float]:
    """Least margin of each probe, from contact to the end of the last force [m]."""
    return [float(series["margin_m"][rows].min()) for rows in probes_of(series)]


def peak_shares(run: RecordedRun) -> np.ndarray:
    """(n,) true over asked normal force at the envelope's peak, of the probes held to their end."""
    force = {key: np.array(value) for key, value in run.result["probe_force"].items()}
    last = force["force_index"] == ENVELOPE_FORCES - 1
    return force["true_n"][last] / np.maximum(force["asked_n"][last], 1.0)


def report(evidence: Evidence) -> list[Part]:
    """The probe in which the CoM goes furthest without eq. (5), the same one with it, and all in numbers."""
    arms = evidence.arms
    rows = []
    for arm, label in ARMS.items():
        for run in arms.get(arm, []):
            series = run.arrays("forces")
            least, shares = margins(series), peak_shares(run)
            rows.append(
                [
                    f"{label}, seed {run.spec.seed}",
                    str(len(least)),
                    f"{1e3 * min(least):.0f}" if least else "–",
                    str(sum(each < 0.0 for each in least)),
                    f"{np.median(shares):.2f}" if len(shares) else "–",
                    f"{shares.min():.2f}" if len(shares) else "–",
                    f"{errors(series)['mpc / asked']:.1f}",
                    f"{errors(series)['true / mpc']:.1f}",
                ]
            )
    head = ["", "probes", "least margin mm", "CoM outside", "force / peak, median", "least"]
    head += ["MPC − asked, RMSE N", "true − MPC, RMSE N"]
    table = Table(
        "From contact to the end of the last force. Margin: true CoM to the nearest edge of the three other feet, "
        "negative outside. Force / peak: true over asked normal force at the envelope's largest.",
        head,
        rows,
    )
    shown = _probe_shown(arms)
    if shown is None:
        return [Words("One of the two arms has no probe: nothing to compare."), table]
    return [_figure(evidence, arms, *shown), table]


def _probe_shown(arms: dict[str, list[RecordedRun]]) -> tuple[int, int] | None:
    """(which run, which probe) goes furthest to the edge without eq. (5), among those both arms have."""
    best, least = None, np.inf
    for index, pair in enumerate(zip(*(arms.get(arm, []) for arm in ARMS), strict=False)):
        without, with_it = (margins(run.arrays("forces")) for run in pair)
        for probe, margin in enumerate(without[: len(with_it)]):
            if margin < least:
                best, least = (index, probe), margin
    return best


def stability_row(
    panels: Sequence[Axes],
    series: dict[str, np.ndarray],
    rows: np.ndarray,
    title: str,
    names: Sequence[str] = ("asked", "mpc"),
) -> None:
    """Normal, x and y of the named forces of one probe, and the polygon of the other feet, in four panels."""
    t, leg = series["t"][rows] - series["t"][rows[0]], int(series["leg"][rows[0]])
    parts = components(series, rows, names)
    for axes, values, name in zip(panels, parts, (f"{title}, normal", "x", "y"), strict=False):
        force_panel(axes, t, values, name)
    polygon_panel(panels[3], series["p_WF"][rows[-1]], leg, series["com_W"][rows], series["margin_m"][rows])


def _figure(evidence: Evidence, arms: dict[str, list[RecordedRun]], index: int, probe: int) -> Pictures:
    with styled():
        figure = new_figure(11.0, 5.6)
        grid = figure.subplots(2, 4, width_ratios=[1.2, 1.0, 1.0, 1.25], sharey="col")
        for line, (arm, label) in zip(grid, ARMS.items(), strict=True):
            series = arms[arm][index].arrays("forces")
            rows = probes_of(series)[probe]
            stability_row(line, series, rows, f"{label}: {LEGS[series['leg'][rows[0]]]}")
        handles, labels = grid[0, 0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside upper center", ncols=2)
        path = save(figure, evidence.folder / "polygon_and_force.svg")
    caption = (
        f"Seed {arms['full'][index].spec.seed}, probe {probe + 1}: the one in which the CoM goes furthest without "
        "the constraint. Orange: asked by the envelope; blue: force of the MPC. Right: the other three feet and "
        "the CoM's projection while probing."
    )
    return Pictures(caption, [path], ["Forces and support polygon without and with eq. (5)"])


EXPERIMENT = Experiment(
    "fig09_polygon_and_force",
    "Fig. 9 – Stability against force",
    "Without the support polygon constraint the MPC tracks the envelope fully, but the centre of mass can leave "
    "the polygon of the other three feet. With it the centre of mass stays inside and the force falls somewhat "
    "short.",
    specs,
    report,
)
