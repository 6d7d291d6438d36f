"""From the paper to the code: nothing of the paper is missing, and each file says that it is its place."""

import ast
import re

import pytest
from markdown_pages import ROOT

from surefoot.config.ocp import Ocp

PAGE = (ROOT / "docs" / "paper_to_code.md").read_text()
EQUATIONS = ["1a", "1b", "1c", "1d", "1e", "2", "3", "4", "5", "6", "7"]
ROWS = [
    [cell.strip() for cell in line.strip("|").split("|")] for line in PAGE.splitlines() if line.startswith("| ")
]
PLACES = [
    (row[0], file) for row in ROWS for file in re.findall(r"`([\w/]+\.py)`", row[-1]) if "ocp." not in row[-2]
]
BARRIERS = [row for row in ROWS if row[-2].startswith("`ocp.")]
CONTROL = [path for room in ("components", "hw", "config") for path in sorted((ROOT / room).rglob("*.py"))]


def named_equations(text):
    """Numbers of the equations that a text names; "eqs. (1)-(4)" names four, "eq. (1c)" the first one too."""
    found = set()
    for numbers in re.findall(r"[Ee]qs?\.\s*((?:\(\d[a-e]?\)(?:\s*(?:,|-|–|and|or)\s*)?)+)", text):
        for first, last in re.findall(r"\((\d[a-e]?)\)(?:[-–]\((\d)\))?", numbers):
            found |= {first, *(str(n) for n in range(int(first[0]), int(last or first[0]) + 1))}
    return found


def names(text, item):
    """Whether a source names an equation, a section or a figure of the paper."""
    if item.startswith("("):
        return item.strip("()") in named_equations(text)
    number = item.split()[1]
    if item.startswith("Sec."):
        return re.search(rf"Sec\. {re.escape(number)}(?!\w|\.\d)", text)
    return re.search(rf"Figs?\. {number}\b", text)


@pytest.mark.parametrize("equation", EQUATIONS)
def test_every_equation_has_a_file(equation):
    assert f"({equation})" in {item for item, _ in PLACES}


@pytest.mark.parametrize(("item", "file"), PLACES)
def test_a_file_that_is_named_names_its_place_in_the_paper(item, file):
    assert names((ROOT / file).read_text(), item), f"{file} does not name {item}"


@pytest.mark.parametrize("path", CONTROL, ids=lambda path: str(path.relative_to(ROOT)))
def test_a_file_that_is_an_equation_is_on_the_page(path):
    """What its docstring begins with is what it is."""
    begins = re.match(r"Eq\. (\(\d[a-e]?\)):", ast.get_docstring(ast.parse(path.read_text())) or "")
    if begins:
        assert (begins[1], str(path.relative_to(ROOT))) in PLACES


@pytest.mark.parametrize("row", BARRIERS, ids=lambda row: row[0])
def test_table_1_is_the_default(row):
    barrier = getattr(Ocp(), row[3].strip("`").removeprefix("ocp."))
    assert (barrier.mu, barrier.delta) == (float(row[1]), float(row[2]))
    assert "Table I" in (ROOT / row[4].strip("`")).read_text()


def test_table_1_has_its_seven_rows():
    assert len(BARRIERS) == 7
