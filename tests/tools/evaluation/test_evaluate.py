"""Many runs: each costs only itself, and what is written is what was measured."""

import json
from multiprocessing import active_children

import pytest
import works

from surefoot.config.deployment import Deployment
from surefoot.config.typed_toml import ConfigError
from surefoot.tools.evaluation import one_run
from surefoot.tools.evaluation.evaluate import evaluate, summary
from surefoot.tools.evaluation.workers import run_apart

RUN_KEYS = {
    "seed", "success", "failure", "sim_time_s", "wall_time_s", "real_time_factor", "distance_m", "footholds",
    "probes", "candidates_tried", "collapses_detected", "missed_collapses", "false_alarms", "precision", "recall",
    "displacement_at_detection_m", "unload_s", "min_support_margin_m", "max_tilt_rad", "probe_force", "estimator",
    "timing_ms", "mpc_violation_max", "torque_saturation_s", "energy_j",
}  # fmt: skip
OF_THE_MACHINE = {"wall_time_s", "real_time_factor", "timing_ms"}
LIMIT_S = 3.0  # the first probe has begun to press


@pytest.fixture
def scenario(tmp_path):
    path = tmp_path / "level.toml"
    path.write_text('[terrain]\nkind = "flat"\n')
    return path


def told(scenario, seeds, work, **options):
    """Results, and what was said; each time something is said, the file holds that run and those before it."""
    said, out = [], scenario.parent / "out"

    def say(line):
        said.append(line)
        assert len(json.loads((out / "results.json").read_text())["runs"]) == len(said)

    results = evaluate(scenario, seeds, out, say=say, work=work, **options)
    assert json.loads((out / "results.json").read_text()) == results
    return results, said


def failures(results):
    return {run["seed"]: run["failure"] for run in results["runs"]}


def test_a_killed_worker_costs_its_own_seed_alone(scenario):
    results, said = told(scenario, range(5), works.one_is_killed, jobs=2)
    assert failures(results) == {0: None, 1: "error: worker died (exit code -9)", 2: None, 3: None, 4: None}
    assert [run["success"] for run in results["runs"]] == [True, False, True, True, True]
    assert any(line.startswith("seed 1: error: worker died") for line in said) and len(said) == 5


def test_a_run_that_raises_is_its_own_failure(scenario):
    results, _ = told(scenario, range(3), works.one_raises)
    assert failures(results) == {0: None, 1: "error: RuntimeError: the solver has gone for a walk", 2: None}


def test_a_crash_inside_the_stack_is_the_runs_failure_and_says_where(monkeypatch):
    def broken(deployment):
        raise ZeroDivisionError("no ground")

    monkeypatch.setattr(one_run, "Lockstep", broken)
    run = one_run.grade(Deployment())
    assert run["seed"] == 0 and not run["success"]
    assert run["failure"].startswith("error: ZeroDivisionError: no ground (test_evaluate.py:")


def test_no_more_than_the_asked_jobs_run_at_once(scenario):
    results, _ = told(scenario, range(5), works.notes_itself, jobs=2)
    assert len(results["runs"]) == 5
    assert max(run["at_once"] for run in results["runs"]) <= 2


def test_who_stops_listening_leaves_no_worker_behind(scenario):
    runs = run_apart(works.one_sleeps, [(scenario, [], seed, 1.0) for seed in range(3)], 2)
    next(runs)
    runs.close()
    assert (scenario.parent / "asleep").exists() and not (scenario.parent / "awake").exists()
    assert not active_children()


def test_arm_and_overrides_reach_every_run_and_the_file(scenario):
    results, said = told(
        scenario, [4, 2], works.crosses, arm="threshold=0.02", overrides=["fsm.goal_m=0.3"], limit_s=7.0
    )
    assert [run["seed"] for run in results["runs"]] == [2, 4]
    asked = ["level", "fsm.collapse_m=0.02", "fsm.goal_m=0.3", 7.0]
    assert all(run["asked"] == asked for run in results["runs"])
    assert len({run["pid"] for run in results["runs"]}) == 2
    assert results["scenario"] == "level" and results["arm"] == "threshold=0.02" and results["version"]
    assert results["config"]["fsm"]["collapse_m"] == 0.02 and results["config"]["fsm"]["goal_m"] == 0.3
    assert sorted(said) == ["seed 2: crossed, 12 s simulated", "seed 4: crossed, 12 s simulated"]
    assert (scenario.parent / "out" / "summary.md").read_text() == summary(results)


def test_a_wrong_call_runs_nothing(scenario):
    out = scenario.parent / "out"
    with pytest.raises(ValueError, match="no arm 'half'"):
        evaluate(scenario, [0], out, arm="half")
    with pytest.raises(ConfigError, match="did you mean"):
        evaluate(scenario, [0], out, overrides=["fsm.gaol_m=1.0"])
    with pytest.raises(ConfigError, match="--jobs 0: at least one"):
        evaluate(scenario, [0], out, jobs=0)
    assert not out.exists()


# The summary of hand-made runs --------------------------------------------------------------------------


def run(seed, **figures):
    """A whole run; what is not given is dull."""
    forces = {key: [] for key in ("force_index", "asked_n", "mpc_n", "wbc_n", "estimated_n", "true_n")}
    dull = {
        "seed": seed, "success": True, "failure": None, "sim_time_s": 100.0, "real_time_factor": 0.8,
        "footholds": 10, "probes": 50, "collapses_detected": 4, "missed_collapses": 0, "late_collapses": 0,
        "false_alarms": 0, "min_support_margin_m": 0.041, "max_tilt_rad": 0.1,
        "displacement_at_detection_m": [], "unload_s": [], "probe_force": forces,
        "probe_rmse_n": {"true_vs_mpc": 1.26, "estimate_vs_true": 2.14},
        "estimator": {"xy_drift_per_m": 0.0042, "z_error_max_m": 0.01, "tilt_error_max_rad": 0.01},
    }  # fmt: skip
    return dull | figures


def summed(*runs):
    return summary({"scenario": "planks", "arm": "full", "runs": list(runs)})


def test_the_summary_counts_runs_footholds_and_probes():
    text = summed(
        run(0, missed_collapses=1, late_collapses=2, false_alarms=3),
        run(1, success=False, failure="fell", missed_collapses=2, min_support_margin_m=None, sim_time_s=14.4),
        {"seed": 2, "success": False, "failure": "error: worker died (exit code -9)"},
    )
    assert "| 0 | crossed | 100 | 10 | 4 | 1 | 2 | 3 | 41 | 0.10 | 0.80 |" in text
    assert "| 1 | fell | 14 | 10 | 4 | 2 | 0 | 0 | - | 0.10 | 0.80 |" in text
    assert "| 2 | error: worker died (exit code -9) |" in text
    assert "- success 1 of 3\n" in text
    assert "- missed collapses 3 of 20 accepted footholds\n" in text
    assert "- false alarms 3 of 100 probes\n" in text
    assert len({line.count("|") for line in text.splitlines() if line.startswith("|")}) == 1


def test_the_summary_lists_what_each_run_measured():
    still = {"xy_drift_per_m": None, "z_error_max_m": 0.0, "tilt_error_max_rad": 0.02}
    text = summed(run(0), run(1, estimator=still, probe_rmse_n={"true_vs_mpc": 9.0, "estimate_vs_true": 7.0}))
    assert "- true against MPC's force, RMSE N: 1.3, 9.0\n" in text
    assert "- estimate against truth, RMSE N: 2.1, 7.0\n" in text
    assert "- drift of x, y per metre: 0.004\n" in text
    assert "- largest tilt error, degrees: 0.6, 1.1\n" in text
    assert "displacement" not in text and "unloaded" not in text and "peak" not in text


def test_displacement_and_unloading_are_over_all_collapses():
    text = summed(
        run(0, displacement_at_detection_m=[0.030, 0.031], unload_s=[0.02, 0.03]),
        run(1, displacement_at_detection_m=[0.040], unload_s=[0.13]),
    )
    # Between order statistics numpy interpolates: 95 % of three is 3.1 + 0.9 * 0.9.
    assert "- displacement at detection, cm: median 3.1, p95 3.9\n" in text
    assert "- unloaded after detection, ms: median 30, max 130\n" in text


def test_peaks_are_those_of_the_last_force_whatever_comes_before_and_after():
    # A probe that breaks off at 70 N, one to 90 N, one that begins higher than the last ended, and the next run.
    first = {
        "force_index": [3, 4, 0, 4, 5, 0, 5],
        "asked_n": [60.0, 70.0, 40.0, 80.0, 90.0, 95.0, 100.0],
        "true_n": [10.0, 10.0, 10.0, 10.0, 81.0, 10.0, 98.0],
    }
    second = {"force_index": [5], "asked_n": [200.0], "true_n": [200.0]}
    text = summed(run(0, probe_force=first), run(1, probe_force=second))
    assert "- true force over the envelope's peak: median 0.98, least 0.90 of 3 probes\n" in text


def test_nothing_but_errors_is_summed_up_too():
    text = summed({"seed": 0, "success": False, "failure": "error: worker died (exit code -9)"})
    assert "worker died" in text and "success" not in text


# True runs ----------------------------------------------------------------------------------------------


def test_true_runs_fill_every_field_and_do_not_depend_on_the_jobs(scenario):
    def graded(jobs):
        out = scenario.parent / f"jobs-{jobs}"
        results = evaluate(scenario, [0, 1], out, jobs=jobs, limit_s=LIMIT_S)
        assert json.loads((out / "results.json").read_text()) == results
        return results

    results = graded(1)
    for each in results["runs"]:
        assert each.keys() >= RUN_KEYS
        assert each["failure"] == "timeout" and each["sim_time_s"] == pytest.approx(LIMIT_S)
        assert each["probes"] > 0 and each["probe_force"]["true_n"]
        assert {"p50", "p99", "max"} == each["timing_ms"]["mpc"].keys()
        assert {"xy_drift_per_m", "z_error_max_m", "tilt_error_max_rad"} == each["estimator"].keys()
        assert {"asked_n", "mpc_n", "wbc_n", "estimated_n", "true_n"} <= each["probe_force"].keys()
    assert results["runs"][0]["probe_force"] != results["runs"][1]["probe_force"]

    def of_the_robot(results):
        return [{key: run[key] for key in run.keys() - OF_THE_MACHINE} for run in results["runs"]]

    assert of_the_robot(results) == of_the_robot(graded(2))
