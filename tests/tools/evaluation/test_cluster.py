"""Runs on a Dask cluster are the runs of this machine, and what goes wrong there is told here."""

import json
import sys
from time import monotonic, sleep

import dask
import pytest
import works
from distributed import LocalCluster

from surefoot.config.typed_toml import ConfigError
from surefoot.tools.evaluation import cluster as on_cluster
from surefoot.tools.evaluation.cluster import run_on_cluster
from surefoot.tools.evaluation.evaluate import evaluate


def start(workers):
    quick = {"distributed.scheduler.allowed-failures": 0}
    with dask.config.set(quick):
        return LocalCluster(
            n_workers=workers, threads_per_worker=1, processes=True, dashboard_address=":0", silence_logs=50
        )


@pytest.fixture(scope="module")
def cluster():
    with start(2) as cluster:
        yield cluster


@pytest.fixture
def address(cluster):
    cluster.wait_for_workers(2, timeout=30)  # one that was killed comes back
    return cluster.scheduler_address


@pytest.fixture
def scenario(tmp_path):
    path = tmp_path / "level.toml"
    path.write_text('[terrain]\nkind = "flat"\n[mpc]\nprofile = "light"\n')
    return path


def calls(scenario, count):
    return [(scenario, [], seed, 1.0) for seed in range(count)]


def failures(results):
    return {run["seed"]: run["failure"] for run in results["runs"]}


def test_every_run_has_a_process_of_its_own_and_is_told_as_it_ends(scenario, address):
    said, out = [], scenario.parent / "out"

    def say(line):
        said.append(line)
        assert len(json.loads((out / "results.json").read_text())["runs"]) == len(said)

    results = evaluate(scenario, range(4), out, say=say, work=works.crosses, cluster=address, limit_s=7.0)
    assert all(run["asked"] == ["level", 7.0] for run in results["runs"])
    assert len({run["pid"] for run in results["runs"]}) == 4 and len(said) == 4


def test_a_run_that_dies_or_raises_there_costs_itself_alone(scenario, address):
    killed = evaluate(scenario, range(3), scenario.parent / "killed", work=works.one_is_killed, cluster=address)
    assert failures(killed) == {0: None, 1: "error: worker died (exit code -9)", 2: None}
    raised = evaluate(scenario, range(3), scenario.parent / "raised", work=works.one_raises, cluster=address)
    assert failures(raised) == {0: None, 1: "error: RuntimeError: the solver has gone for a walk", 2: None}


def test_a_worker_that_dies_costs_the_run_that_it_had(scenario, address):
    ended = {
        call[2]: result for call, result in run_on_cluster(works.one_kills_its_worker, calls(scenario, 4), address)
    }
    assert [ended[seed]["success"] for seed in range(4)] == [True, False, True, True]
    assert ended[1]["failure"].startswith("error: KilledWorker")


def test_who_stops_listening_leaves_no_run_behind(scenario, address):
    runs = run_on_cluster(works.one_sleeps, calls(scenario, 3), address)
    next(runs)
    runs.close()
    pid = int((scenario.parent / "asleep").read_text())
    deadline = monotonic() + 15.0
    while works.lives(pid) and monotonic() < deadline:
        sleep(0.1)
    assert not works.lives(pid) and not (scenario.parent / "awake").exists()


def test_a_true_run_there_gives_the_bytes_of_one_here(scenario, address):
    def graded(name, **where):
        run = evaluate(scenario, [0], scenario.parent / name, limit_s=1.7, **where)["runs"][0]
        assert run["failure"] == "timeout"
        of_the_machine = {"wall_time_s": 0, "real_time_factor": 0, "timing_ms": 0}
        return json.dumps(run | of_the_machine)

    assert graded("there", cluster=address) == graded("here")


def test_a_cluster_that_goes_away_is_told_and_what_is_done_is_kept(scenario, monkeypatch):
    monkeypatch.setattr(on_cluster, "_CONNECT_S", 3.0)
    cluster = start(2)
    out = scenario.parent / "out"

    def say(line):
        cluster.close()

    with pytest.raises(ConfigError, match=r"the cluster went away with 2 of 3 runs to do; call again"):
        evaluate(scenario, range(3), out, say=say, work=works.later_ones_sleep, cluster=cluster.scheduler_address)
    assert len(json.loads((out / "results.json").read_text())["runs"]) == 1


def test_an_address_where_nobody_answers_is_named(scenario, monkeypatch):
    monkeypatch.setattr(on_cluster, "_CONNECT_S", 0.5)
    for address in ("tcp://127.0.0.1:9", "nonsense://here"):
        with pytest.raises(ConfigError, match=rf"--dask {address}: no Dask scheduler there"):
            evaluate(scenario, [0], scenario.parent / "out", work=works.crosses, cluster=address)


def test_a_cluster_without_workers_is_told_how_to_get_some(scenario, monkeypatch):
    monkeypatch.setattr(on_cluster, "_CONNECT_S", 0.5)
    with start(0) as cluster, pytest.raises(ConfigError, match="it has no worker; start some: dask worker tcp"):
        evaluate(scenario, [0], scenario.parent / "out", work=works.crosses, cluster=cluster.scheduler_address)


def test_workers_of_another_state_of_the_program_are_refused(scenario, address, monkeypatch):
    monkeypatch.setattr(works, "STATE", "another")
    monkeypatch.setattr(on_cluster, "source_digest", works.other_digest)
    with pytest.raises(ConfigError, match="run another state of surefoot; install this state"):
        evaluate(scenario, [0], scenario.parent / "out", work=works.crosses, cluster=address)


def test_without_dask_it_is_said_how_to_get_it(scenario, monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(ConfigError, match=r"pip install 'surefoot\[cluster\]'"):
        evaluate(scenario, [0], scenario.parent / "out", work=works.crosses, cluster="tcp://127.0.0.1:9")
