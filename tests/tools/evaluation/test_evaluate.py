"""Many runs: each costs only itself, and what is written is what was measured."""

import json
import os
import subprocess
import sys
from multiprocessing import active_children
from time import monotonic, sleep

import pytest
import works

from surefoot.config.deployment import Deployment
from surefoot.config.typed_toml import ConfigError
from surefoot.tools.cli import main
from surefoot.tools.evaluation import one_run, results_file
from surefoot.tools.evaluation.evaluate import evaluate
from surefoot.tools.evaluation.summary import summary
from surefoot.tools.evaluation.workers import run_apart
from surefoot.tools.recording.replay import replay

RUN_KEYS = {
    "seed", "success", "failure", "sim_time_s", "wall_time_s", "real_time_factor", "distance_m", "footholds",
    "probes", "candidates_tried", "collapses_detected", "missed_collapses", "false_alarms", "precision", "recall",
    "displacement_at_detection_m", "unload_s", "min_support_margin_m", "max_tilt_rad", "probe_force", "estimator",
    "timing_ms", "mpc_violation_max", "torque_saturation_s", "energy_j", "in_hole", "rejected_by_map",
    "candidates_per_foothold", "edge_distance_m", "stop_reason",
}  # fmt: skip
OF_THE_MACHINE = {"wall_time_s", "real_time_factor", "timing_ms"}
LIMIT_S = 3.0  # the first probe has begun to press


@pytest.fixture
def scenario(tmp_path):
    path = tmp_path / "level.toml"
    path.write_text('[terrain]\nkind = "flat"\n[mpc]\nprofile = "light"\n')
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


def test_for_a_script_there_is_one_object_and_nothing_else(scenario, capfd):
    call = [
        "eval",
        str(scenario),
        "--seeds",
        "0",
        "--limit",
        "0.5",
        "--json",
        "--out",
        str(scenario.parent / "out"),
    ]
    assert main(call) == 1
    said, aside = capfd.readouterr()
    told = json.loads(said)
    assert (told["runs"], told["succeeded"], told["failures"]) == (1, 0, {"0": "timeout"})
    assert "seed 0: timeout" in aside and {row["met"] for row in told["marks"]} <= {True, False, None}


def test_a_run_is_recorded_and_can_be_replayed(scenario, tmp_path):
    results = evaluate(scenario, [0], tmp_path / "out", limit_s=0.5, record=True, say=lambda line: None)
    assert failures(results) == {0: "timeout"}
    result = replay(tmp_path / "out" / "seed_0.mcap", ["estimator", "fsm"])
    assert result.comparison.equal and result.steps["estimator"] == 251
    with pytest.raises(ConfigError, match="--record with --dask"):
        evaluate(scenario, [0], tmp_path / "out", record=True, cluster="tcp://nowhere:1")


def test_a_killed_worker_costs_its_own_seed_alone(scenario):
    results, said = told(scenario, range(5), works.one_is_killed, jobs=2)
    assert failures(results) == {0: None, 1: "error: worker died (exit code -9)", 2: None, 3: None, 4: None}
    assert [run["success"] for run in results["runs"]] == [True, False, True, True, True]
    assert any(line.startswith("seed 1: error: worker died") for line in said) and len(said) == 5


def test_a_run_that_raises_is_its_own_failure(scenario):
    results, _ = told(scenario, range(3), works.one_raises)
    assert failures(results) == {0: None, 1: "error: RuntimeError: the solver has gone for a walk", 2: None}


def test_a_crash_inside_the_stack_is_the_runs_failure_and_says_where(monkeypatch):
    def broken(deployment, given):
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


def test_no_worker_outlives_an_evaluation_that_is_killed(scenario):
    code = "\n".join(
        (
            "import sys, pathlib, works",
            "from surefoot.tools.evaluation.workers import run_apart",
            "if __name__ == '__main__':",
            "    call = (pathlib.Path(sys.argv[1]), [], 1, 1.0)",
            "    list(run_apart(works.one_sleeps, [call], 1))",
        )
    )
    script = scenario.parent / "evaluation.py"
    script.write_text(code)
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)}
    with subprocess.Popen([sys.executable, str(script), str(scenario)], env=environment) as evaluation:
        asleep, deadline = scenario.parent / "asleep", monotonic() + 30.0
        while not asleep.exists() and monotonic() < deadline:
            sleep(0.05)
        worker = int(asleep.read_text())
        evaluation.kill()
    while works.lives(worker) and monotonic() < deadline:
        sleep(0.05)
    assert not works.lives(worker) and not (scenario.parent / "awake").exists()


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
    assert sorted(said) == ["seed 2: success, 12 s simulated", "seed 4: success, 12 s simulated"]
    assert (scenario.parent / "out" / "summary.md").read_text() == summary(results)


def test_vision_is_as_asked_or_else_as_the_deployment_says(scenario):
    for vision, asked in ((True, ["run.vision=true"]), (False, ["run.vision=false"]), (None, [])):
        results, _ = told(scenario, [0], works.crosses, vision=vision, fresh=True)
        assert results["vision"] is (vision is True) and results["config"]["run"]["vision"] is (vision is True)
        assert results["runs"][0]["asked"] == ["level", *asked, 1200.0]
    scenario.write_text("[run]\nvision = true\n")
    assert told(scenario, [0], works.crosses, fresh=True)[0]["vision"] is True


# Once more into the same folder -------------------------------------------------------------------------


def test_seeds_that_are_there_are_not_done_again(scenario):
    first, _ = told(scenario, [0, 3], works.crosses)
    said = []
    out = scenario.parent / "out"
    again = evaluate(scenario, range(5), out, say=said.append, work=works.crosses)
    assert [run["seed"] for run in again["runs"]] == [0, 1, 2, 3, 4]
    assert [again["runs"][seed] for seed in (0, 3)] == first["runs"]  # with the process that did them then
    assert said[0] == "2 of 5 seeds are there already" and len(said) == 4
    assert json.loads((out / "results.json").read_text()) == again
    fewer = evaluate(scenario, [1], out, say=said.append, work=works.one_raises)
    assert fewer == again and len(said) == 5


def test_a_run_that_ended_with_an_error_is_done_again_and_a_failure_of_the_robot_is_not(scenario):
    told(scenario, range(3), works.one_raises)
    out = scenario.parent / "out"
    mended = evaluate(scenario, range(3), out, say=lambda line: None, work=works.falls)
    assert failures(mended) == {0: None, 1: "fell", 2: None}
    assert failures(evaluate(scenario, range(3), out, say=lambda line: None, work=works.crosses)) == failures(
        mended
    )


def test_fresh_forgets_what_is_there(scenario):
    told(scenario, [0, 3], works.falls)
    results, said = told(scenario, [3], works.crosses, fresh=True)
    assert failures(results) == {3: None} and len(said) == 1


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"arm": "mpc_only"}, "runs with arm = 'full', asked is 'mpc_only'"),
        ({"vision": True}, "runs with vision = False, asked is True"),
        ({"overrides": ["fsm.goal_m=0.7"]}, r"runs with config.fsm.goal_m = [0-9.]+, asked is 0.7"),
        ({"limit_s": 5.0}, r"runs with limit_s = 1200.0, asked is 5.0"),
    ],
)
def test_runs_of_another_evaluation_are_neither_mixed_nor_lost(scenario, change, words):
    told(scenario, [0], works.crosses)
    file = scenario.parent / "out" / "results.json"
    before = file.read_text()
    with pytest.raises(ConfigError, match=words) as refused:
        evaluate(scenario, [1], file.parent, work=works.crosses, **change)
    assert "--fresh forgets" in str(refused.value) and file.read_text() == before


def test_runs_of_another_program_are_not_taken_for_this_ones(scenario, monkeypatch):
    told(scenario, [0], works.crosses)
    monkeypatch.setattr(results_file, "source_digest", lambda: "changed")
    with pytest.raises(ConfigError, match="runs of another state of the program"):
        evaluate(scenario, [1], scenario.parent / "out", work=works.crosses)


@pytest.mark.parametrize("text", ["", "[]", '{"runs": 3}', "{}"])
def test_a_file_that_is_none_of_ours_is_left_alone(scenario, text):
    out = scenario.parent / "out"
    out.mkdir()
    (out / "results.json").write_text(text)
    with pytest.raises(ConfigError, match="is not a file of results; --fresh"):
        evaluate(scenario, [0], out, work=works.crosses)
    assert (out / "results.json").read_text() == text


def test_a_wrong_call_runs_nothing(scenario):
    out = scenario.parent / "out"
    with pytest.raises(ValueError, match="no arm 'half'"):
        evaluate(scenario, [0], out, arm="half")
    with pytest.raises(ConfigError, match="did you mean"):
        evaluate(scenario, [0], out, overrides=["fsm.gaol_m=1.0"])
    with pytest.raises(ConfigError, match="--jobs 0: at least one"):
        evaluate(scenario, [0], out, jobs=0)
    assert not out.exists()


# True runs ----------------------------------------------------------------------------------------------


def test_true_runs_fill_every_field_and_do_not_depend_on_the_jobs(scenario):
    def graded(jobs):
        out = scenario.parent / f"jobs-{jobs}"
        results = evaluate(scenario, [0, 1], out, jobs=jobs, limit_s=LIMIT_S)
        assert json.loads((out / "results.json").read_text()) == results
        return results

    results = graded(1)
    assert results["vision"] is False and results["limit_s"] == LIMIT_S
    for each in results["runs"]:
        assert each.keys() >= RUN_KEYS
        assert each["failure"] == "timeout" and each["sim_time_s"] == pytest.approx(LIMIT_S)
        assert each["probes"] > 0 and each["probe_force"]["true_n"]
        for part in ("mpc", "trajopt", "wbc", "estimator", "physics"):
            assert {"p50", "p99", "max"} == each["timing_ms"][part].keys()
        # The plant steps inside io's step.
        assert 0.0 < each["timing_ms"]["physics"]["p50"] < each["timing_ms"]["io"]["p50"]
        assert {"xy_drift_per_m", "z_error_max_m", "tilt_error_max_rad"} == each["estimator"].keys()
        assert {"asked_n", "mpc_n", "wbc_n", "estimated_n", "true_n"} <= each["probe_force"].keys()
    assert results["runs"][0]["probe_force"] != results["runs"][1]["probe_force"]

    def of_the_robot(results):
        return [{key: run[key] for key in run.keys() - OF_THE_MACHINE} for run in results["runs"]]

    assert of_the_robot(results) == of_the_robot(graded(2))


def test_the_true_state_arm_walks_on_the_truth(scenario):
    results = evaluate(scenario, [0], scenario.parent / "out", arm="true_state", limit_s=LIMIT_S)
    run = results["runs"][0]
    assert run["probes"] > 0 and run["failure"] == "timeout"
    # One cycle old, and by nothing else away from the truth: the filter is 2 N away.
    assert run["probe_rmse_n"]["estimate_vs_true"] < 0.5 and run["estimator"]["z_error_max_m"] < 2e-3
