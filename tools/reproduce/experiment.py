"""What an experiment is: the runs it needs, and the part of the page it makes of them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from surefoot.config.reproduce import Reproduce
from surefoot.tools.document import Part, Pictures, Table
from surefoot.tools.reproduce.recorded_run import RecordedRun, by_arm
from surefoot.tools.reproduce.run_spec import RunSpec
from surefoot.tools.reproduce.snapshots import Darkroom, Shot


@dataclass(frozen=True)
class Plan:
    """How the experiments are run this time.

    Attributes:
        settings: lengths and starts.
        seeds: asked for; empty: each experiment's own.
        quick: the short version.
    """

    settings: Reproduce = field(default_factory=Reproduce)
    seeds: tuple[int, ...] = ()
    quick: bool = False

    def seeds_or(self, own: Sequence[int]) -> tuple[int, ...]:
        """The seeds that were asked for, each once; or an experiment's own, in the quick version one."""
        return tuple(dict.fromkeys(self.seeds)) or tuple(own[:1] if self.quick else own)


@dataclass(frozen=True)
class Evidence:
    """What an experiment reports from.

    Attributes:
        plan: how it was run.
        runs: those that are whole.
        failed: why each of the others is missing, by the run's name.
        folder: for its pictures.
        darkroom: renders snapshots.
    """

    plan: Plan
    runs: Sequence[RecordedRun]
    failed: dict[str, str]
    folder: Path
    darkroom: Darkroom

    @property
    def arms(self) -> dict[str, list[RecordedRun]]:
        """The runs by arm."""
        return by_arm(self.runs)

    def snapshots(self, run: RecordedRun, shots: Sequence[tuple[Shot, str]], caption: str) -> Pictures:
        """Rendered pictures with their labels, or the reason why there are none."""
        missing = self.darkroom.develop(run.spec, [shot for shot, _ in shots])
        files = [] if missing else [shot.path for shot, _ in shots]
        return Pictures(caption, files, [label for _, label in shots], missing)


@dataclass(frozen=True)
class Experiment:
    """One figure of the paper.

    Attributes:
        name: of its folder.
        title: on the page.
        claim: what the paper says, in our words.
        specs: the runs, for a plan.
        report: what they show.
    """

    name: str
    title: str
    claim: str
    specs: Callable[[Plan], Sequence[RunSpec]]
    report: Callable[[Evidence], Sequence[Part]]


def verdict(run: RecordedRun, quick: bool) -> str:
    """How a run ended, in words."""
    result = run.result
    if result["success"]:
        return "crossed" if run.spec.deployment().terrain.kind != "flat" else "goal reached"
    if result["failure"] == "timeout" and quick:
        return f"cut off after {run.spec.limit_s:.0f} s"
    return {"timeout": "time out", "contact": f"touched with {result['body_contact']}"}.get(
        result["failure"], result["failure"]
    )


def cut_off(runs: Sequence[RecordedRun], quick: bool) -> bool:
    """Every run was cut off by the quick version before it was decided."""
    return quick and all(run.result["failure"] == "timeout" for run in runs)


def per_foothold(runs: Sequence[RecordedRun]) -> str:
    """Candidates tried for each accepted foothold, over runs, in words."""
    footholds = sum(run.result["footholds"] for run in runs)
    tried = sum(run.result["candidates_tried"] for run in runs)
    if not runs:
        return "no run"
    return f"{tried / footholds:.2f} ({tried} for {footholds})" if footholds else "none accepted"


def crossing_table(runs: Sequence[RecordedRun], quick: bool, caption: str, start: bool = False) -> Table:
    """Runs over a terrain, one in a row."""
    head = ["seed", "result", "time s", "footholds", "candidates", "collapses", "sank later", "least margin mm"]
    rows = []
    for run in runs:
        result = run.result
        margin = result["min_support_margin_m"]
        rows.append(
            [
                str(run.spec.seed),
                verdict(run, quick),
                f"{result['sim_time_s']:.0f}",
                str(result["footholds"]),
                str(result["candidates_tried"]),
                str(result["collapses_detected"]),
                str(result["missed_collapses"]),
                "–" if margin is None else f"{1e3 * margin:.0f}",
            ]
        )
        if start:
            offset = run.spec.deployment().terrain.planks.start_offset_m
            rows[-1].insert(1, f"{1e2 * offset:.0f}")
    stopped = [f"seed {run.spec.seed}: {why}" for run in runs if (why := run.result.get("stop_reason"))]
    if stopped:
        caption += f" At rest at the end, in the robot's own words: {'; '.join(stopped)}."
    return Table(caption, [head[0], "start cm", *head[1:]] if start else head, rows)
