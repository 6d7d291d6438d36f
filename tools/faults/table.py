"""The drill's results as a page."""

from __future__ import annotations

from surefoot.tools.faults.case import PHASES, Result

_ORDER = ("kill", "pause", "restart")


def table(results: list[Result]) -> str:
    """Fault and process by phase, in Markdown; a case that did not go as declared is bold."""
    found = {(r.case.fault, r.case.process, r.case.phase): r for r in results}
    phases = [phase for phase in PHASES if any(r.case.phase == phase for r in results)]
    rows = list(dict.fromkeys((r.case.fault, r.case.process) for r in results))
    rows.sort(key=lambda row: _ORDER.index(row[0]))
    lines = ["| fault | " + " | ".join(phases) + " |", "|---" * (1 + len(phases)) + "|"]
    for fault, process in rows:
        cells = [_cell(found.get((fault, process, phase))) for phase in phases]
        lines.append(f"| {fault} {process} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def told(results: list[Result]) -> str:
    """What an operator read of each fault and process, once each, in Markdown."""
    words: dict[tuple[str, str], str] = {}
    for result in results:
        if result.told:
            words.setdefault((result.case.fault, result.case.process), result.told)
    return "\n".join(f"- {fault} {process}: `{said[:200]}`" for (fault, process), said in words.items())


def _cell(result: Result | None) -> str:
    if result is None:
        return "–"
    words = result.outcome
    if result.seconds is not None:
        words += f"; safe after {result.seconds:.2f} s"
    return words if result.good else f"**{words}**"
