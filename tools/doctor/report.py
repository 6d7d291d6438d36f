"""Findings as lines for people and as JSON for scripts."""

from __future__ import annotations

import json
from dataclasses import asdict

from rich.markup import escape

from surefoot.tools.doctor.check import Finding, Findings, Level, failures

_STYLE = {Level.OK: "green", Level.WARN: "yellow", Level.FAIL: "bold red", Level.NOT_HERE: "dim"}


def as_lines(findings: Findings) -> list[str]:
    """One line each, in rich's markup, and one in the end for all."""
    lines = []
    for group, each in findings.items():
        lines.append(f"[bold]{group}[/bold]")
        lines += [_line(finding) for finding in each]
    return [*lines, _all_in_all(findings)]


def as_json(findings: Findings) -> str:
    """`ok`, and the findings by group."""
    groups = {group: [asdict(finding) for finding in each] for group, each in findings.items()}
    return json.dumps({"ok": not failures(findings), "groups": groups}, indent=1)


def words_of(finding: Finding) -> str:
    """What was found, and where it is not well what was expected and what to do."""
    words = f"{finding.check}: {finding.found}"
    if finding.level in (Level.WARN, Level.FAIL):
        words += f"; expected {finding.expected}" if finding.expected else ""
        words += f". {finding.remedy}" if finding.remedy else ""
    return words


def _line(finding: Finding) -> str:
    style = _STYLE[finding.level]
    return f"  [{style}]{finding.level:4}[/{style}]  {escape(words_of(finding))}"


def _all_in_all(findings: Findings) -> str:
    levels = [finding.level for each in findings.values() for finding in each]
    counts = [f"{levels.count(level)} {level}" for level in Level if level in levels]
    return ", ".join(counts)
