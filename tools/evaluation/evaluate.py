"""Many graded runs in parallel processes, `results.json` and `summary.md`."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path

from surefoot.config.deployment import load_deployment
from surefoot.config.typed_toml import ConfigError
from surefoot.tools.evaluation.arms import TRUE_STATE, arm_overrides
from surefoot.tools.evaluation.cluster import run_on_cluster
from surefoot.tools.evaluation.one_run import LIMIT_S, grade
from surefoot.tools.evaluation.results_file import ResultsFile
from surefoot.tools.evaluation.workers import Work, run_apart


def grade_seed(
    scenario: Path,
    changes: Sequence[str],
    seed: int,
    limit_s: float,
    true_state: bool = False,
    record: Path | None = None,
) -> dict:
    """Grade one seed of a deployment file, saying how it goes; `record` is the folder for its recording."""
    deployment = load_deployment(scenario, [*changes, f"hw.seed={seed}"])
    file = record / f"seed_{seed}.mcap" if record is not None else None

    def say(line: str) -> None:
        print(f"seed {seed}: {line}", flush=True)

    return grade(deployment, limit_s, say, true_state, record=file)


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
    vision: bool | None = None,
    fresh: bool = False,
    cluster: str = "",
    record: bool = False,
) -> dict:
    """Grade a deployment file over seeds; writes `results.json` after every run, so nothing is lost.

    Args:
        scenario: the deployment file.
        seeds: each is one run; those that `results.json` has already are not done again.
        out: folder for `results.json` and `summary.md`.
        arm: named change of the deployment.
        overrides: more changes, applied after the arm's.
        jobs: runs at the same time on this machine.
        limit_s: simulated time that counts as a time-out.
        say: told a line whenever a run ends.
        work: does one run.
        vision: with or without the depth camera; None as the deployment says.
        fresh: forget the runs that are there.
        cluster: address of a Dask scheduler whose workers do the runs instead of this machine; "" none.
        record: keep a recording of every run, `seed_N.mcap`, in the folder.

    Raises:
        ConfigError: the deployment, an override or the arm is wrong, its robot is not simulated, there is less
            than one job, the folder holds the runs of another evaluation, or the cluster cannot do them.
    """
    if jobs < 1:
        raise ConfigError(f"--jobs {jobs}: at least one")
    if record and cluster:
        raise ConfigError("--record with --dask: the recordings would lie on the workers' disks; use --jobs")
    changes = [*arm_overrides(arm), *overrides]
    if vision is not None:
        changes.append(f"run.vision={str(vision).lower()}")
    deployment = load_deployment(scenario, changes)
    if deployment.hw.backend != "mujoco":
        raise ConfigError(
            f"hw.backend = {deployment.hw.backend!r}: runs are graded with the simulator's truth; set 'mujoco'"
        )
    file = ResultsFile(out, scenario.stem, arm, deployment, limit_s)
    if not fresh:
        file.resume()
    missing = file.missing(seeds)
    if len(missing) < len(set(seeds)):
        say(f"{len(set(seeds)) - len(missing)} of {len(set(seeds))} seeds are there already")
    if arm == TRUE_STATE:
        work = partial(work, true_state=True)
    if record:
        out.mkdir(parents=True, exist_ok=True)
        work = partial(work, record=out.resolve())
    calls = [(scenario, changes, seed, limit_s) for seed in missing]
    runs = run_on_cluster(work, calls, cluster) if cluster and calls else run_apart(work, calls, jobs)
    for (_, _, seed, _), graded in runs:
        run = {"seed": seed} | graded
        file.add(run)
        verdict = "success" if run["success"] else run["failure"]
        say(f"seed {seed}: {verdict}, {run.get('sim_time_s', 0.0):.0f} s simulated")
    file.write()
    return file.results
