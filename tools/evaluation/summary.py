"""`summary.md`: the runs of one `results.json` to read, and the marks they are measured by."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict
from typing import Any

import numpy as np

from surefoot.tools.evaluation.marks import judge
from surefoot.tools.evaluation.pooled import Pooled, Run

_HEAD = (
    "seed", "result", "time s", "footholds", "tries each", "collapses", "missed", "late", "false", "in hole",
    "by map", "margin mm", "tilt rad", "RTF",
)  # fmt: skip
_MET = {True: "yes", False: "NO", None: "-"}


def summary(results: dict) -> str:
    """The runs as a table, the measures over all of them, and the marks that apply to them."""
    sight = {None: "", True: ", with vision", False: ", blind"}[results.get("vision")]
    lines = [f"# {results['scenario']}, arm {results['arm']}{sight}", "", _row(_HEAD), _rule(_HEAD)]
    pooled = Pooled(results["runs"])
    lines += [_row(_run_cells(run)) for run in pooled.runs]
    if pooled.whole:
        lines += ["", *_totals(pooled)]
    rows = judge(results)
    if rows and pooled.whole:
        head = ("mark", "asked", "got", "met")
        lines += ["", _row(head), _rule(head)]
        lines += [_row((row.mark, row.asked, row.got, _MET[row.met])) for row in rows]
    return "\n".join(lines) + "\n"


def outcome(results: dict) -> dict[str, Any]:
    """What came of the runs, for a script: how each ended, and the marks; every measure is in `results.json`."""
    runs = results["runs"]
    return {
        "scenario": results["scenario"],
        "arm": results["arm"],
        "vision": results.get("vision"),
        "runs": len(runs),
        "succeeded": sum(run["success"] for run in runs),
        "failures": {str(run["seed"]): run["failure"] for run in runs if not run["success"]},
        "marks": [asdict(row) for row in judge(results)],
    }


def _row(cells: Iterable[object]) -> str:
    return "| " + " | ".join(str(cell).replace("|", "/") for cell in cells) + " |"


def _rule(head: tuple[str, ...]) -> str:
    return "|" + "---|" * len(head)


def _run_cells(run: Run) -> list[str]:
    result = "success" if run["success"] else str(run["failure"])
    if "footholds" not in run:
        return [str(run["seed"]), result] + [""] * (len(_HEAD) - 2)
    counts = (
        "collapses_detected",
        "missed_collapses",
        "late_collapses",
        "false_alarms",
        "in_hole",
        "rejected_by_map",
    )
    return [
        str(run["seed"]),
        result,
        f"{run['sim_time_s']:.0f}",
        str(run["footholds"]),
        _figure(run["candidates_per_foothold"], 1),
        *(str(run[count]) for count in counts),
        _figure(run["min_support_margin_m"], 0, 1e3),
        f"{run['max_tilt_rad']:.2f}",
        f"{run['real_time_factor']:.2f}",
    ]


def _totals(pooled: Pooled) -> list[str]:
    tilt = np.rad2deg(pooled.each("estimator", "tilt_error_max_rad"))
    lines = [
        f"- success {pooled.succeeded} of {len(pooled.runs)}",
        f"- missed collapses {pooled.total('missed_collapses')} of {pooled.total('footholds')} accepted footholds",
        f"- false alarms {pooled.total('false_alarms')} of {pooled.total('probes')} probes",
        f"- precision {_figure(pooled.precision, 3)}, recall {_figure(pooled.recall, 3)}, of all runs together",
        f"- in doubt by the press test itself: {pooled.total('doubtful_alarms')} of the false alarms, "
        f"{pooled.total('doubtful_misses')} of {pooled.total('false_negatives')} misses",
        f"- true against MPC's force, RMSE N: {_list(pooled.each('probe_rmse_n', 'true_vs_mpc'))}",
        f"- estimate against truth, RMSE N: {_list(pooled.each('probe_rmse_n', 'estimate_vs_true'))}",
        f"- drift of x, y per metre: {_list(pooled.each('estimator', 'xy_drift_per_m'), 3)}",
        f"- largest error of height, cm: {_list(1e2 * pooled.each('estimator', 'z_error_max_m'))}",
        f"- largest tilt error, degrees: {_list(tilt)}",
    ]
    peaks = pooled.peak_shares
    if len(peaks):
        lines.append(
            f"- true force over the envelope's peak: median {np.median(peaks):.2f}, least {peaks.min():.2f} "
            f"of {len(peaks)} probes"
        )
    moved, unload = 1e2 * pooled.all("displacement_at_detection_m"), 1e3 * pooled.all("unload_s")
    if len(moved):
        median, most = np.percentile(moved, [50, 95])
        lines.append(f"- displacement at detection, cm: median {median:.1f}, p95 {most:.1f}")
    if len(unload):
        lines.append(f"- unloaded after detection, ms: median {np.median(unload):.0f}, max {unload.max():.0f}")
    edge = pooled.all("edge_distance_m")
    if len(edge):
        lines.append(f"- accepted footholds beside the drop, cm from it: {_list(1e2 * np.sort(edge))}")
    lines += [f"- {name}, wall ms a step: {figures}" for name, figures in _timing(pooled).items()]
    return lines


def _timing(pooled: Pooled) -> dict[str, str]:
    """Of each part: the median of the runs' medians, and the worst of their p99 and of all steps."""
    parts = dict.fromkeys(name for run in pooled.whole for name in run.get("timing_ms", {}))
    columns = {
        name: [pooled.each("timing_ms", name, figure) for figure in ("p50", "p99", "max")] for name in parts
    }
    return {
        name: f"p50 {np.median(p50):.2f}, p99 {p99.max():.2f}, max {most.max():.1f}"
        for name, (p50, p99, most) in columns.items()
    }


def _figure(value: float | None, digits: int, scale: float = 1.0) -> str:
    return "-" if value is None else f"{scale * value:.{digits}f}"


def _list(values: np.ndarray, digits: int = 1) -> str:
    return ", ".join(f"{value:.{digits}f}" for value in values) or "-"
