"""The robot's faults and what came of them, as a page."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

from surefoot.tools.evaluation.source import source_digest
from surefoot.tools.faults.robot_drill import AFTER_S, PHASES, RobotDrill, RobotResult
from surefoot.tools.faults.robot_fault import FAULTS, RobotFault

Say = Callable[[str], None]


def robot_page(
    config: Path, settings: Sequence[str], out: Path, say: Say, faults: Sequence[RobotFault] = FAULTS
) -> bool:
    """Carry out every fault in every phase and write the page.

    Args:
        config: a deployment of an emulated robot in simulated time; the ground is flat whatever it says.
        settings: overrides.
        out: the page, in Markdown, written after each fault.
        say: told of each.
        faults: which.

    Returns:
        Whether all went as declared.
    """
    drill, results = RobotDrill(config, settings), []
    for fault in faults:
        for phase in PHASES:
            results.append(drill.carry_out(fault, phase))
            say(f"{fault.name}, {phase}: {_cell(results[-1])}")
        out.write_text(results_page(results, drill.limit_cycles))
    return all(result.good for result in results)


def results_page(results: list[RobotResult], limit: Callable[[RobotFault], int | None]) -> str:
    """What came of faults, each in all phases; `limit`: of each, until it is damped [cycles]."""
    found = {(result.fault.name, result.phase): result for result in results}
    names = list(dict.fromkeys(result.fault.name for result in results))
    lines = [
        f"Sources {source_digest()}. Watched for {AFTER_S:g} s; a cycle is 2 ms; **bold** is what did not go as "
        "declared.",
        "",
        "| fault | declared | " + " | ".join(PHASES) + " |",
        "|---|---|" + "---|" * len(PHASES),
    ]
    for name in names:
        rows = [found[name, phase] for phase in PHASES]
        cells = [_cell(row) if row.good else f"**{_cell(row)}**" for row in rows]
        lines.append(f"| {name} | {_declared(rows[0].fault, limit)} | " + " | ".join(cells) + " |")
    said = {name: found[name, phase].told for phase in PHASES for name in names if found[name, phase].told}
    lines += ["", "What was read of it first:", ""]
    return "\n".join(lines + [f"- {name}: `{words}`" for name, words in said.items()]) + "\n"


def _declared(fault: RobotFault, limit: Callable[[RobotFault], int | None]) -> str:
    cycles = limit(fault)
    return fault.declared.value if cycles is None else f"{fault.declared.value}, within {cycles} cycles"


def _cell(result: RobotResult) -> str:
    driven = "driven on" if result.damped_after is None else f"damped after {result.damped_after} cycles"
    return f"{driven}, {result.outcome}"
