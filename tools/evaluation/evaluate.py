"""Many graded runs in parallel processes, `results.json` and `summary.md`."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from importlib.metadata import version
from pathlib import Path

import numpy as np

from surefoot.config.deployment import load_deployment
from surefoot.config.typed_toml import ConfigError, to_table
from surefoot.tools.evaluation.arms import arm_overrides
from surefoot.tools.evaluation.grader import ENVELOPE_FORCES
from surefoot.tools.evaluation.one_run import LIMIT_S, grade
from surefoot.tools.evaluation.workers import Work, run_apart


def grade_seed(scenario: Path, changes: Sequence[str], seed: int, limit_s: float) -> dict:
    """Grade one seed of a deployment file, saying how it goes."""
    deployment = load_deployment(scenario, [*changes, f"hw.seed={seed}"])
    return grade(deployment, limit_s, lambda line: print(f"seed {seed}: {line}", flush=True))


def evaluate(
    scenario: Path,
    seeds: Sequence[int],
    out: Path,
    arm: str = "full",
    overrides: Sequence[str] = (),
    jobs: int = 1,
    limit_s: float = LIMIT_S,
    say: Callable[[str], None] = print,
    work: Work = grade_seed,
) -> dict:
    """Grade a deployment file over seeds; writes `results.json` after every run, so nothing is lost.

    Raises:
        ConfigError: the deployment, an override or the arm is wrong, or there is less than one job.
    """
    if jobs < 1:
        raise ConfigError(f"--jobs {jobs}: at least one")
    changes = [*arm_overrides(arm), *overrides]
    deployment = load_deployment(scenario, changes)
    out.mkdir(parents=True, exist_ok=True)
    results = {
        "scenario": scenario.stem,
        "arm": arm,
        "config": to_table(deployment),
        "version": version("surefoot"),
        "runs": [],
    }
    calls = [(scenario, changes, seed, limit_s) for seed in seeds]
    for (_, _, seed, _), graded in run_apart(work, calls, jobs):
        entry = {"seed": seed} | graded
        results["runs"] = sorted([*results["runs"], entry], key=lambda each: each["seed"])
        (out / "results.json").write_text(json.dumps(results, indent=1))
        (out / "summary.md").write_text(summary(results))
        verdict = "crossed" if entry["success"] else entry["failure"]
        say(f"seed {seed}: {verdict}, {entry.get('sim_time_s', 0.0):.0f} s simulated")
    return results


def summary(results: dict) -> str:
    """The runs as a table, and the measures over all of them."""
    lines = [
        f"# {results['scenario']}, arm {results['arm']}",
        "",
        "| seed | result | time s | footholds | collapses | missed | late | false | margin mm | tilt rad | RTF |",
        "|---|---|---|---|---|---|---|---|---|---|---|",
    ]
    runs = results["runs"]
    whole = [run for run in runs if "footholds" in run]
    for run in runs:
        result = "crossed" if run["success"] else run["failure"]
        if "footholds" not in run:
            lines.append(f"| {run['seed']} | {result} |" + " |" * 9)
            continue
        margin = run["min_support_margin_m"]
        lines.append(
            f"| {run['seed']} | {result} | {run['sim_time_s']:.0f} | {run['footholds']} "
            f"| {run['collapses_detected']} | {run['missed_collapses']} | {run['late_collapses']} "
            f"| {run['false_alarms']} | {'-' if margin is None else f'{1e3 * margin:.0f}'} "
            f"| {run['max_tilt_rad']:.2f} | {run['real_time_factor']:.2f} |"
        )
    if whole:
        lines += ["", *_totals(runs, whole)]
    return "\n".join(lines) + "\n"


def _totals(runs: list[dict], whole: list[dict]) -> list[str]:
    def total(key: str) -> int:
        return sum(run[key] for run in whole)

    moved = [value for run in whole for value in run["displacement_at_detection_m"]]
    unload = [value for run in whole for value in run["unload_s"]]
    drift = [run["estimator"]["xy_drift_per_m"] for run in whole if run["estimator"]["xy_drift_per_m"] is not None]
    lines = [
        f"- success {sum(run['success'] for run in runs)} of {len(runs)}",
        f"- missed collapses {total('missed_collapses')} of {total('footholds')} accepted footholds",
        f"- false alarms {total('false_alarms')} of {total('probes')} probes",
        f"- true against MPC's force, RMSE N: {_list(run['probe_rmse_n']['true_vs_mpc'] for run in whole)}",
        f"- estimate against truth, RMSE N: {_list(run['probe_rmse_n']['estimate_vs_true'] for run in whole)}",
        f"- drift of x, y per metre: {_list(drift, 3)}",
        "- largest tilt error, degrees: "
        + _list(np.rad2deg([r["estimator"]["tilt_error_max_rad"] for r in whole])),
    ]
    peaks = _peak_shares(whole)
    if len(peaks):
        lines.append(
            f"- true force over the envelope's peak: median {np.median(peaks):.2f}, least {peaks.min():.2f} "
            f"of {len(peaks)} probes"
        )
    if moved:
        lines.append(f"- displacement at detection, cm: median {_cm(moved, 50)}, p95 {_cm(moved, 95)}")
    if unload:
        lines.append(
            f"- unloaded after detection, ms: median {1e3 * np.median(unload):.0f}, max {1e3 * max(unload):.0f}"
        )
    return lines


def _peak_shares(runs: list[dict]) -> np.ndarray:
    """(n,) true over asked normal force at the envelope's peak, of the probes that were held to their end."""
    forces = [run["probe_force"] for run in runs]
    index, asked, true = (np.concatenate([f[key] for f in forces]) for key in ("force_index", "asked_n", "true_n"))
    # Forces come by rising normal force.
    last = index == ENVELOPE_FORCES - 1
    return true[last] / np.maximum(asked[last], 1.0)


def _list(values, digits: int = 1) -> str:
    return ", ".join(f"{value:.{digits}f}" for value in values) or "-"


def _cm(values: list[float], percentile: float) -> str:
    return f"{1e2 * np.percentile(values, percentile):.1f}"
