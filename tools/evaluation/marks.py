"""The marks that the stack is to reach, and how far `results.json` says that it does."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from surefoot.tools.evaluation.pooled import Pooled, is_error

NEAR_DROP_M = 0.025
"""A foothold nearer to a drop than the foot's pad is wide should not be accepted."""

Judged = tuple[str, bool | None]
"""What was got, in words, and whether that is enough; None where nothing could be measured."""

_NOTHING: Judged = "-", None


@dataclass(frozen=True)
class Row:
    """One mark against what was measured.

    Attributes:
        mark: what is judged.
        asked: the mark.
        got: what was measured; "-" for nothing.
        met: None where nothing was measured.
    """

    mark: str
    asked: str
    got: str
    met: bool | None


@dataclass(frozen=True)
class Mark:
    """One mark.

    Attributes:
        name: what is judged.
        asked: in words.
        measure: judges the runs.
        grounds: scenarios that it is asked on, or kinds of terrain for a scenario that no mark names; () any that
            gives it something to judge.
        arms: that it is asked of.
        reference: of the base while probing (`fsm.base_reference`) that it is asked with; "" any.
    """

    name: str
    asked: str
    measure: Callable[[Pooled], Judged]
    grounds: tuple[str, ...] = ()
    arms: tuple[str, ...] = ("full",)
    reference: str = ""


def judge(results: dict) -> list[Row]:
    """The marks that apply to the scenario and arm of a `results.json`, each with what was got."""
    pooled = Pooled(results["runs"])
    config = results.get("config", {})
    known = {ground for mark in MARKS for ground in mark.grounds}
    ground = results["scenario"] if results["scenario"] in known else config.get("terrain", {}).get("kind", "")
    reference = config.get("fsm", {}).get("base_reference", "")
    rows = []
    for mark in MARKS:
        if results["arm"] not in mark.arms or (mark.grounds and ground not in mark.grounds):
            continue
        if mark.reference and mark.reference != reference:
            continue
        got, met = mark.measure(pooled)
        if mark.grounds or met is not None:
            rows.append(Row(mark.name, mark.asked, got, met))
    return rows


# Measures -----------------------------------------------------------------------------------------------


def _succeeds(share: float, never: tuple[str, ...] = ()) -> Callable[[Pooled], Judged]:
    """At least a share of the runs is a success, and none fails in one of the ways named."""

    def measure(pooled: Pooled) -> Judged:
        n, bad = len(pooled.runs), pooled.failed_with(*never)
        if not n:
            return _NOTHING
        named = "".join(f", {bad} {failure}" for failure in never)
        return f"{pooled.succeeded} of {n}{named}", pooled.succeeded >= share * n and not bad

    return measure


def _fails(share: float) -> Callable[[Pooled], Judged]:
    """At least a share of the runs fails by the robot's doing; an error of the program proves nothing."""

    def measure(pooled: Pooled) -> Judged:
        done = [run for run in pooled.runs if not is_error(run)]
        failed = sum(not run["success"] for run in done)
        return (f"{failed} of {len(done)}", failed >= share * len(done)) if done else _NOTHING

    return measure


def _mean_time(limit_s: float) -> Callable[[Pooled], Judged]:
    def measure(pooled: Pooled) -> Judged:
        times = [run["sim_time_s"] for run in pooled.whole if run["success"]]
        return (f"{np.mean(times):.0f} s", bool(np.mean(times) < limit_s)) if times else _NOTHING

    return measure


def _share(count: str, of: str, limit: float) -> Callable[[Pooled], Judged]:
    """One count over another, at most."""

    def measure(pooled: Pooled) -> Judged:
        part, whole = pooled.total(count), pooled.total(of)
        return (f"{part} of {whole}, {100 * part / whole:.1f} %", part <= limit * whole) if whole else _NOTHING

    return measure


def _at_least(figure: Callable[[Pooled], float | None], limit: float) -> Callable[[Pooled], Judged]:
    def measure(pooled: Pooled) -> Judged:
        got = figure(pooled)
        return _NOTHING if got is None else (f"{got:.3f}", got >= limit)

    return measure


def _displacement(pooled: Pooled) -> Judged:
    moved = pooled.all("displacement_at_detection_m")
    if not len(moved):
        return _NOTHING
    median, most = np.percentile(moved, [50, 95])
    return f"median {1e2 * median:.2f} cm, p95 {1e2 * most:.2f} cm", bool(median <= 0.033 and most <= 0.045)


def _unloading(pooled: Pooled) -> Judged:
    times = pooled.all("unload_s")
    if not len(times):
        return _NOTHING
    words = f"median {1e3 * np.median(times):.0f} ms, largest {1e3 * times.max():.0f} ms"
    return words, bool(times.max() <= 0.150)


def _rmse(which: str, limit_n: float) -> Callable[[Pooled], Judged]:
    """The worst of the runs; one without a force held tells nothing."""

    def measure(pooled: Pooled) -> Judged:
        held = Pooled([run for run in pooled.whole if run["probe_force"]["true_n"]])
        values = held.each("probe_rmse_n", which)
        if not len(values):
            return _NOTHING
        return f"{values.min():.1f}–{values.max():.1f} N", bool(values.max() <= limit_n)

    return measure


def _margin(limit_m: float, below: bool = False) -> Callable[[Pooled], Judged]:
    """The least margin of all runs: at least the limit, or `below` it in one of them."""

    def measure(pooled: Pooled) -> Judged:
        values = pooled.each("min_support_margin_m")
        if not len(values):
            return _NOTHING
        least = float(values.min())
        return f"least {1e3 * least:.0f} mm", least < limit_m if below else least >= limit_m

    return measure


def _peak(pooled: Pooled) -> Judged:
    shares = pooled.peak_shares
    if not len(shares):
        return _NOTHING
    return f"median {np.median(shares):.2f}, least {shares.min():.2f}", bool(shares.min() >= 0.80)


def _near_drop(some: bool) -> Callable[[Pooled], Judged]:
    """How many of the footholds beside a drop were accepted too close to it: none, or `some`."""

    def measure(pooled: Pooled) -> Judged:
        distances = pooled.all("edge_distance_m")
        if not len(distances):
            return _NOTHING
        near = int((distances < NEAR_DROP_M).sum())
        least = 1e2 * distances.min()
        return f"{near} of {len(distances)}, nearest {least:.1f} cm", bool(near) == some

    return measure


# The table ----------------------------------------------------------------------------------------------

MARKS = (
    Mark(
        "success",
        "≥ 9 of 10, no fall",
        _succeeds(0.9, never=("fell",)),
        grounds=("planks", "planks_missing", "rocks"),
    ),
    Mark("baseline fails", "≥ 8 of 10", _fails(0.8), grounds=("planks",), arms=("mpc_only",)),
    Mark("mean simulated time", "< 390 s", _mean_time(390.0), grounds=("planks",)),
    Mark("stops", "every time", _succeeds(1.0), grounds=("trap",)),
    Mark(
        "missed collapses",
        "≤ 2 % of accepted footholds",
        _share("missed_collapses", "footholds", 0.02),
    ),
    Mark("recall", "≥ 0.95", _at_least(lambda pooled: pooled.recall, 0.95), grounds=("tiles",)),
    Mark("precision", "≥ 0.90", _at_least(lambda pooled: pooled.precision, 0.90), grounds=("tiles",)),
    Mark("false alarms", "≤ 2 % of probes", _share("false_alarms", "probes", 0.02), grounds=("flat",)),
    Mark("false alarms", "≤ 10 % of probes", _share("false_alarms", "probes", 0.10), grounds=("foam",)),
    Mark("displacement at detection", "median ≤ 3.3 cm, p95 ≤ 4.5 cm", _displacement),
    Mark("unloaded after detection", "≤ 150 ms", _unloading),
    Mark(
        "Fig. 10: true against the MPC's normal force, RMSE",
        "≤ 10 N in every run",
        _rmse("true_vs_mpc", 10.0),
        grounds=("flat",),
    ),
    Mark(
        "Fig. 10: estimate of eq. (7) against truth, RMSE",
        "≤ 8 N in every run",
        _rmse("estimate_vs_true", 8.0),
        grounds=("flat",),
    ),
    Mark("Fig. 9: CoM inside the polygon", "≥ 10 mm", _margin(0.010), grounds=("flat",), reference="stride"),
    Mark("Fig. 9: true force over the envelope's peak", "≥ 0.80", _peak, grounds=("flat",), reference="stride"),
    Mark(
        "Fig. 9: without eq. (5) the CoM leaves the polygon",
        "in some probes",
        _margin(0.0, below=True),
        grounds=("flat",),
        arms=("no_support_polygon",),
        reference="stride",
    ),
    Mark("accepted within 2.5 cm of the drop", "none", _near_drop(some=False), grounds=("edge",)),
    Mark(
        "accepted within 2.5 cm of the drop",
        "some",
        _near_drop(some=True),
        grounds=("edge",),
        arms=("no_probe_around",),
    ),
)
"""Every mark of the stack, in one place."""
