"""Runs the paper's experiments, each run once, and writes the page, its figures and the data beside it."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable, Iterator, Sequence
from importlib.metadata import version
from pathlib import Path

from surefoot.config.typed_toml import ConfigError, to_table
from surefoot.tools.document import Part, Words, write_document
from surefoot.tools.evaluation.marks import judge
from surefoot.tools.evaluation.pooled import is_error
from surefoot.tools.evaluation.workers import Work, run_apart
from surefoot.tools.reproduce import force_tracking, missing_planks, planks, polygon_and_force, rocks
from surefoot.tools.reproduce.experiment import Evidence, Experiment, Plan
from surefoot.tools.reproduce.page import Page, Section
from surefoot.tools.reproduce.recorded_run import RECORDERS, RecordedRun, by_arm, is_whole, record, sources
from surefoot.tools.reproduce.recording.recorder import Column, write_csv
from surefoot.tools.reproduce.run_spec import RunSpec
from surefoot.tools.reproduce.snapshots import Darkroom

EXPERIMENTS: tuple[Experiment, ...] = (
    planks.EXPERIMENT,
    polygon_and_force.EXPERIMENT,
    force_tracking.EXPERIMENT,
    missing_planks.EXPERIMENT,
    rocks.EXPERIMENT,
)
"""In the order of the paper's figures."""

PAGE = "index.html"

_MET = {True: "reached", False: "not reached", None: "nothing measured"}

RUN_COLUMNS = (
    Column("arm", "as `surefoot eval` knows it"),
    Column("seed", "of the plant and its noise"),
    Column("success", "1 the terrain was crossed, on flat ground the goal reached"),
    Column("failure", "fell, stuck, contact, stopped, timeout; empty after a success"),
    Column("stop_reason", "what the state machine said when the run ended at rest; otherwise empty"),
    Column("sim_time_s", "simulated time [s]"),
    Column("wall_time_s", "time on the wall [s]"),
    Column("distance_m", "of the trunk along x [m]"),
    Column("footholds", "accepted"),
    Column("probes", "presses of six forces, points around included"),
    Column("candidates_tried", "footholds probed, accepted or not"),
    Column("collapses_detected", "while probing"),
    Column("missed_collapses", "accepted feet that later sank more than 3 cm"),
    Column("late_collapses", "of accepted footholds, noticed by the state machine"),
    Column("false_alarms", "collapses called where the press test holds"),
    Column("min_support_margin_m", "true CoM to the edge of the three other feet, lift-off to end of probing [m]"),
    Column("max_tilt_rad", "of the trunk [rad]"),
    Column("energy_j", "sum of |torque x velocity| over time [J]"),
)
"""Of `runs.csv` in each experiment's folder."""


def reproduce(
    out: Path,
    plan: Plan,
    jobs: int = 1,
    say: Callable[[str], None] = print,
    command: str = "surefoot reproduce",
    experiments: Sequence[Experiment] = EXPERIMENTS,
    darkroom: Darkroom | None = None,
    work: Work = record,
) -> Path:
    """Run what is missing, draw everything, write the page; returns its path.

    Whole runs of the same settings and sources are kept, so a second call goes on where the first was stopped.

    Raises:
        ConfigError: less than one job.
    """
    if jobs < 1:
        raise ConfigError(f"--jobs {jobs}: at least one")
    out.mkdir(parents=True, exist_ok=True)
    specs, failed = _specs(experiments, plan)
    _run_missing(out, specs, failed, jobs, say, work)
    darkroom = darkroom or Darkroom()
    sections = [
        _section(out, each, specs[each.name], failed[each.name], plan, darkroom, say) for each in experiments
    ]
    path = out / PAGE
    write_document(_page(command, plan, specs, sections).html(), path)
    say(f"written: {path}")
    return path


def _specs(
    experiments: Sequence[Experiment], plan: Plan
) -> tuple[dict[str, list[RunSpec]], dict[str, dict[str, str]]]:
    """The runs of each experiment that can be set up, and why the others cannot."""
    specs: dict[str, list[RunSpec]] = {}
    failed: dict[str, dict[str, str]] = {}
    for experiment in experiments:
        specs[experiment.name], failed[experiment.name] = [], {}
        for spec in experiment.specs(plan):
            try:
                spec.deployment()
            except ConfigError as error:
                failed[experiment.name][spec.name] = str(error)
            else:
                specs[experiment.name].append(spec)
    return specs, failed


def _run_missing(
    out: Path,
    specs: dict[str, list[RunSpec]],
    failed: dict[str, dict[str, str]],
    jobs: int,
    say: Callable[[str], None],
    work: Work,
) -> None:
    calls = [(spec, out / name / "runs" / spec.name) for name, each in specs.items() for spec in each]
    missing = [call for call in calls if not is_whole(*call)]
    say(f"runs: {len(calls)}, whole already: {len(calls) - len(missing)}")
    for number, ((spec, folder), result) in enumerate(run_apart(work, missing, jobs), 1):
        name = folder.parent.parent.name
        end = "success" if result["success"] else result["failure"]
        say(
            f"[{number}/{len(missing)}] {name} {spec.name}: {end}, {result.get('sim_time_s', 0.0):.0f} s simulated"
        )
        if is_error(result):
            failed[name][spec.name] = result["failure"]


def _section(
    out: Path,
    experiment: Experiment,
    specs: Sequence[RunSpec],
    failed: dict[str, str],
    plan: Plan,
    darkroom: Darkroom,
    say: Callable[[str], None],
) -> Section:
    """Draw what the runs of an experiment show; drawing is quick, so it is done anew each time."""
    say(f"drawing {experiment.name}")
    folder = out / experiment.name
    figures = folder / "figures"
    shutil.rmtree(figures, ignore_errors=True)
    figures.mkdir(parents=True)
    runs = [
        RecordedRun(spec, folder / "runs" / spec.name)
        for spec in specs
        if is_whole(spec, folder / "runs" / spec.name)
    ]
    evidence = Evidence(plan, runs, failed, figures, darkroom)
    parts: list[Part] = list(experiment.report(evidence)) if runs else [Words("There is no run to report.")]
    write_csv(folder / "runs.csv", RUN_COLUMNS, [_run_row(run) for run in runs])
    for label, same in by_arm(runs).items():
        (folder / f"results_{label.replace('=', '_')}.json").write_text(json.dumps(_results(same), indent=1))
    return Section(experiment, parts, failed, [_results(same) for same in by_arm(runs).values()])


def _run_row(run: RecordedRun) -> list[object]:
    told = {"arm": run.spec.arm, "seed": run.spec.seed} | run.result
    row = [told.get(column.name) for column in RUN_COLUMNS]
    return [int(value) if isinstance(value, bool) else "" if value is None else value for value in row]


def _results(runs: Sequence[RecordedRun]) -> dict:
    """Runs of one arm as `surefoot eval` writes them."""
    spec = runs[0].spec
    return {
        "scenario": Path(spec.scenario).stem,
        "arm": spec.arm,
        "vision": spec.deployment().run.vision,
        "limit_s": spec.limit_s,
        "config": to_table(spec.deployment()),
        "version": version("surefoot"),
        "runs": [run.result for run in runs],
    }


def _page(command: str, plan: Plan, specs: dict[str, list[RunSpec]], sections: Sequence[Section]) -> Page:
    facts = [
        ("version", f"surefoot {version('surefoot')}, sources {sources()}, mujoco {version('mujoco')}"),
        *((f"reproduce.{name}", str(value)) for name, value in to_table(plan.settings).items()),
        *((name, _described(each)) for name, each in specs.items()),
    ]
    documents = [
        (
            f"{name}/runs.csv, results_ARM.json",
            "the graded runs of this experiment; JSON as of surefoot eval",
        )
        for name in specs
    ]
    documents.append(
        ("EXPERIMENT/runs/RUN/", "run.json (result and every setting), arrays (.npz) and series (.csv)")
    )
    used = {recorder for each in specs.values() for spec in each for recorder in spec.recorders}
    columns: dict[str, Sequence[Column]] = {"runs": RUN_COLUMNS}
    columns |= {name: recorder.columns for name, recorder in RECORDERS.items() if name in used}
    return Page(
        command=command,
        quick=plan.quick,
        facts=facts,
        sections=sections,
        marks=() if plan.quick else _marks(sections),
        documents=documents,
        columns={name: [(column.name, column.doc) for column in each] for name, each in columns.items()},
    )


def _marks(sections: Sequence[Section]) -> list[tuple[str, str, str, str]]:
    """The evaluation's marks that these runs have something to say to."""
    return [
        (f"{results['scenario']}, {results['arm']}: {row.mark}", row.asked, row.got, _MET[row.met])
        for section in sections
        for results in section.results
        for row in judge(results)
    ]


def _described(specs: Sequence[RunSpec]) -> str:
    """Scenario, arms, seeds and overrides of an experiment's runs, in a line."""
    lines = []
    for (scenario, arm, limit_s), each in _grouped(specs):
        seeds = ", ".join(str(spec.seed) for spec in each)
        overrides = list(dict.fromkeys(text for spec in each for text in spec.overrides))
        lines.append(
            f"{scenario}, arm {arm}, seeds {seeds}, limit {limit_s:g} s; {' '.join(overrides)}".strip("; ")
        )
    return " · ".join(lines) or "not run"


def _grouped(specs: Sequence[RunSpec]) -> Iterator[tuple[tuple[str, str, float], list[RunSpec]]]:
    groups: dict[tuple[str, str, float], list[RunSpec]] = {}
    for spec in specs:
        groups.setdefault((spec.scenario, spec.label or spec.arm, spec.limit_s), []).append(spec)
    yield from groups.items()
