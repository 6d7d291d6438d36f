"""A short experiment from the call to the page: real runs, each made once, and a page that needs nothing else."""

import json
import re
from dataclasses import replace

import numpy as np
import pytest
import stand_ins
from html_page import Page

from surefoot.config.reproduce import Reproduce
from surefoot.config.typed_toml import ConfigError, build, to_table, with_override
from surefoot.tools.reproduce import force_tracking, planks
from surefoot.tools.reproduce.experiment import Plan
from surefoot.tools.reproduce.recorded_run import RECORDERS
from surefoot.tools.reproduce.recording.recorder import read_csv
from surefoot.tools.reproduce.reproduce import EXPERIMENTS, RUN_COLUMNS, reproduce
from surefoot.tools.reproduce.run_spec import RunSpec
from surefoot.tools.reproduce.snapshots import Darkroom

PRESSED_S = 3.3  # the first probe has pressed for some hundred milliseconds
STANDS_S = 0.3
UNITS = {"m": "m", "s": "s", "n": "N", "rad": "rad", "j": "J"}


def forces(plan):
    return [RunSpec("flat", "full", 0, PRESSED_S, ("forces",))]


def stands(plan):
    return [RunSpec("planks", "mpc_only", seed, STANDS_S, ("instants",)) for seed in (0, 1)]


FORCES = replace(force_tracking.EXPERIMENT, specs=forces)
PLANKS = replace(planks.EXPERIMENT, specs=stands)


def needs_nothing_else(html):
    page = Page(html)
    assert page.sources and all(source.startswith("data:image/") for source in page.sources)
    assert all(link.startswith("#") and link[1:] in page.ids for link in page.links)
    assert not re.search(r"https?://|@import|<script|<link|url\(", html)
    return page


def told(out, experiments, **options):
    said = []
    path = reproduce(out, Plan(quick=True), say=said.append, experiments=experiments, **options)
    return path.read_text(encoding="utf-8"), said


@pytest.fixture(scope="module")
def done(tmp_path_factory):
    """Both experiments, run once for the module: folder, page, lines said."""
    out = tmp_path_factory.mktemp("reproduced")
    return out, *told(out, [FORCES, PLANKS])


def test_the_page_shows_the_runs_and_needs_nothing_else(done):
    _, html, said = done
    page = needs_nothing_else(html)
    text = " ".join(page.text)
    for words in (FORCES.title, PLANKS.title, FORCES.claim, "Quick version", "cut off after 0 s"):
        assert words in text
    assert sum(line.startswith("[") for line in said) == 3
    assert any(source.startswith("data:image/svg+xml") for source in page.sources)


def test_the_forces_of_the_page_are_those_of_a_real_press(done):
    out, _, _ = done
    series = dict(np.load(out / FORCES.name / "runs" / "full_seed0" / "forces.npz"))
    rows = series["pressing"] & np.isfinite(series["asked"][:, 2])
    assert rows.sum() > 50 and set(series["leg"]) == {2}
    asked, true = series["asked"][rows, 2], series["true"][rows, 2]
    assert asked.max() > 60.0 and np.median(np.abs(true - asked)) < 0.15 * asked.max()
    assert series["margin_m"].min() > 0.0
    assert (np.diff(series["t"]) > 0.0).all()


def test_every_csv_column_is_documented_with_its_unit(done):
    out, html, _ = done
    found = sorted(out.rglob("*.csv"))
    assert {path.stem for path in found} == {"runs", "forces", "instants"}
    for path in found:
        columns = RUN_COLUMNS if path.stem == "runs" else RECORDERS[path.stem].columns
        head, rows = read_csv(path)
        assert head == [column.name for column in columns] and rows
        assert all(len(row) == len(head) for row in rows)
        for column in columns:
            assert column.doc and f"<td>{column.name}</td>" in html
            unit = re.search(r"_(m|s|n|rad|j)$", column.name)
            assert unit is None or f"[{UNITS[unit[1]]}]" in column.doc, column.name


def test_the_results_are_those_of_an_evaluation(done):
    out, _, _ = done
    results = json.loads((out / PLANKS.name / "results_mpc_only.json").read_text())
    assert results["scenario"] == "planks" and results["arm"] == "mpc_only"
    assert [run["seed"] for run in results["runs"]] == [0, 1]
    assert all(run["failure"] == "timeout" for run in results["runs"])


def test_a_second_call_runs_nothing_and_writes_the_same_page(done):
    out, html, _ = done
    again, said = told(out, [FORCES, PLANKS], work=stand_ins.never)
    assert said[0] == "runs: 3, whole already: 3"
    assert again == html


def test_the_full_version_is_held_against_the_marks(done):
    out, quick, _ = done
    path = reproduce(out, Plan(), say=lambda line: None, experiments=[PLANKS, FORCES], work=stand_ins.never)
    text = " ".join(needs_nothing_else(path.read_text(encoding="utf-8")).text)
    assert "planks, mpc_only: baseline fails ≥ 8 of 10 2 of 2 reached" in text
    assert "Quick version" not in text and "baseline fails" not in quick
    assert "time out" in text and "cut off" not in text


def test_without_a_renderer_the_page_says_so_and_keeps_all_else(done):
    out, _, _ = done
    html, _ = told(out, [PLANKS, FORCES], work=stand_ins.never, darkroom=Darkroom(["nonsense"]))
    page = needs_nothing_else(html)
    text = " ".join(page.text)
    assert "no renderer on this machine (nonsense: " in text
    assert all(source.startswith("data:image/svg+xml") for source in page.sources)


# What is kept, and what is made again -------------------------------------------------------------------


def runs_of(out):
    return {path.name for path in (out / PLANKS.name / "runs").iterdir()}


@pytest.mark.parametrize(
    ("work", "why"),
    [(stand_ins.second_is_killed, "worker died (exit code -9)"), (stand_ins.second_raises, "<gone> for a walk")],
)
def test_a_run_that_fails_is_named_and_made_by_the_next_call(tmp_path, work, why):
    html, said = told(tmp_path, [PLANKS], work=work, darkroom=Darkroom([]))
    assert why in " ".join(Page(html).text)
    assert runs_of(tmp_path) == {"mpc_only_seed0"}
    assert any(why in line for line in said)
    html, said = told(tmp_path, [PLANKS], darkroom=Darkroom([]))
    assert said[0] == "runs: 2, whole already: 1"
    assert why not in " ".join(Page(html).text) and runs_of(tmp_path) == {"mpc_only_seed0", "mpc_only_seed1"}


def test_who_is_interrupted_goes_on_where_it_stopped(tmp_path):
    def impatient(line):
        if line.startswith("[1/"):
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        reproduce(tmp_path, Plan(quick=True), say=impatient, experiments=[PLANKS], darkroom=Darkroom([]))
    assert runs_of(tmp_path) == {"mpc_only_seed0"}
    half = tmp_path / PLANKS.name / "runs" / "mpc_only_seed1"
    half.mkdir()  # as a crash of the machine might leave it
    (half / "run.json").write_text('{"stamp": "')
    _, said = told(tmp_path, [PLANKS], darkroom=Darkroom([]))
    assert said[0] == "runs: 2, whole already: 1"
    assert json.loads((half / "run.json").read_text())["result"]["seed"] == 1


def test_other_settings_make_the_run_again(done):
    out, _, _ = done
    other = replace(
        PLANKS, specs=lambda plan: [replace(spec, overrides=("hw.torque_noise=0.4",)) for spec in stands(plan)[:1]]
    )
    with_noise, said = told(out, [other], work=stand_ins.never, darkroom=Darkroom([]))
    assert said[0] == "runs: 1, whole already: 0"
    assert "is run again" in " ".join(Page(with_noise).text)


def test_a_scenario_that_is_not_there_costs_its_own_section_alone(tmp_path):
    nowhere = replace(PLANKS, name="nowhere", specs=lambda plan: [RunSpec("moon", "full", 0, 1.0, ())])
    html, _ = told(tmp_path, [nowhere], work=stand_ins.never)
    assert "no such file: moon" in " ".join(Page(html).text)


def test_less_than_one_job_is_refused(tmp_path):
    with pytest.raises(ConfigError, match="--jobs 0: at least one"):
        reproduce(tmp_path / "out", Plan(), jobs=0)
    assert not (tmp_path / "out").exists()


# The experiments ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("quick", [False, True])
@pytest.mark.parametrize("experiment", EXPERIMENTS, ids=lambda each: each.name)
def test_every_experiment_can_be_set_up(experiment, quick):
    specs = experiment.specs(Plan(quick=quick))
    assert len({spec.name for spec in specs}) == len(specs)
    for spec in specs:
        assert spec.deployment().hw.seed == spec.seed


def test_five_traversals_start_at_five_places():
    full = [spec for spec in planks.specs(Plan()) if spec.arm == "full"]
    deployments = [spec.deployment() for spec in full]
    starts = [each.terrain.planks.start_offset_m for each in deployments]
    assert [spec.seed for spec in full] == [0, 1, 2, 3, 4] and len(set(starts)) == 5
    # Each has to go as much further as it starts further away.
    assert len({round(each.fsm.goal_m - start, 6) for each, start in zip(deployments, starts, strict=True)}) == 1


def test_seeds_that_are_asked_for_are_run_once_each():
    assert Plan(seeds=(7, 3, 7), quick=True).seeds_or((0, 1)) == (7, 3)
    assert Plan(quick=True).seeds_or((0, 1)) == (0,) and Plan().seeds_or((0, 1)) == (0, 1)


def test_settings_have_limits():
    settings = Reproduce()
    assert build(Reproduce, to_table(settings)) == settings
    for assignment, said in (
        ("start_offsets_m=[]", "give at least one"),
        ("start_offsets_m=[0.05, 3.0]", r"start_offsets_m\[1\] = 3\.0: out of range"),
        ("quick_limit_s=0", "quick_limit_s = 0"),
    ):
        with pytest.raises(ConfigError, match=said):
            build(Reproduce, with_override({}, assignment))
