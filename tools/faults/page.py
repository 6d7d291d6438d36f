"""The whole drill, clock by clock and terrain by terrain, written out after each part: it takes long."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from pathlib import Path

from surefoot.bus.topics import PROCESSES
from surefoot.tools.evaluation.source import source_digest
from surefoot.tools.faults.case import FAULTS, Case, Result, all_cases
from surefoot.tools.faults.drill import Drill, Say
from surefoot.tools.faults.table import table, told

_ANY, _FRONT = (0, 1, 2, 3), (0, 1)
_TRIES = 3


def drill_page(
    configs: Sequence[Path], clocks: Sequence[str], phases: Sequence[str], settings: list[str], out: Path, say: Say
) -> bool:
    """Run every case of the named parts and write the page after each of them.

    With simulated time one run takes all cases of a phase; where the ground may give way a front foot swings and
    probes, on it. On the monotonic clock every case has a run of its own.

    Args:
        configs: deployments, one for each terrain.
        clocks: "simulated", "monotonic".
        phases: of `case.PHASES`.
        settings: overrides of all of them.
        out: the page, in Markdown.
        say: told of each case.

    Returns:
        Whether every case went as declared.
    """
    parts: list[tuple[str, list[Result]]] = []
    for clock in clocks:
        for config in configs:
            results: list[Result] = []
            parts.append((f"{config.stem}, {clock} clock", results))
            for phase in phases:
                say(f"{config.stem}, {clock} clock, {phase}")
                with tempfile.TemporaryDirectory() as folder:
                    drill = Drill(config, settings, Path(folder), say)
                    if clock == "simulated":
                        legs = _ANY if config.stem == "flat" else _FRONT
                        results += drill.simulated(all_cases(phase), legs)
                    else:
                        results += [_tried(drill, case) for case in _monotonic_cases(phase)]
                out.write_text(_page(parts))
    return all(result.good for _, results in parts for result in results)


def _monotonic_cases(phase: str) -> list[Case]:
    return [Case(phase, fault, name) for fault in FAULTS for name in PROCESSES] + [Case(phase, "pause", "all")]


def _tried(drill: Drill, case: Case) -> Result:
    """A case that was not reached, because the machine was too slow to keep the robot up, is tried again."""
    for _ in range(_TRIES):
        result = drill.monotonic(case)
        if not result.outcome.startswith("not reached"):
            break
    return result


def _page(parts: list[tuple[str, list[Result]]]) -> str:
    lines = [f"Sources {source_digest()}."]
    for title, results in parts:
        good = sum(result.good for result in results)
        lines += ["", f"### {title}: {good} of {len(results)} as declared", "", table(results)]
        lines += ["", "What was read:", "", told(results)]
    return "\n".join(lines) + "\n"
