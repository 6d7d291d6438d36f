"""docs/gate.md shows the table of the code."""

import re
from pathlib import Path

import surefoot.hw.gate.check as module
from surefoot.hw.gate.check import Check

PAGE = Path(module.__file__).resolve().parents[2] / "docs" / "gate.md"


def row(check):
    limit = re.sub(r"(hw\.[a-z_.]+)", r"`\1`", check.limit)
    cells = (check.what, limit or "–", check.answer.value, check.latch.value, check.remedy or "–")
    return f"| {' | '.join(cells)} |"


def test_the_page_has_every_row_in_the_tables_order_and_no_other():
    rows = [line for line in PAGE.read_text().splitlines() if line.startswith("| ") and " | " in line]
    assert rows[1:] == [row(check) for check in Check]
