"""The reference of settings says what the sections of `config/` say."""

from dataclasses import dataclass, field
from typing import Annotated, Literal

from surefoot.config.deployment import Deployment, load_deployment
from surefoot.config.typed_toml import Within
from surefoot.tools.reference.notes import notes
from surefoot.tools.reference.settings import as_toml, sections
from surefoot.tools.reference.settings_page import settings_page


@dataclass(frozen=True)
class Spring:
    """A part.

    Attributes:
        rest_m: where it pushes nothing; told
            on two lines.
    """

    rest_m: float = 0.1
    stiffness: Annotated[float, Within(1.0, 1e5)] = 300.0  # the line beside it counts [N/m]


@dataclass(frozen=True)
class Board:
    """A whole."""

    # A line above a field without one beside it.
    kind: Literal["oak", "pine"] = "pine"

    # What moves.
    spring: Spring = field(default_factory=lambda: Spring(stiffness=500.0))
    hinges: tuple[int, int] = (1, 2)


def test_a_field_has_its_note_from_beside_it_above_it_or_the_docstring():
    assert notes(Spring)["rest_m"].text == "where it pushes nothing; told on two lines."
    assert notes(Spring)["stiffness"].text == "the line beside it counts [N/m]"
    assert notes(Board)["kind"].text == "A line above a field without one beside it."
    assert notes(Board)["hinges"].group == "What moves." and notes(Board)["kind"].group == ""


def test_a_section_tells_default_limits_and_unit():
    board, spring = sections(Board, "board")
    kind, hinges = board.settings
    assert (kind.default, kind.allowed) == ('"pine"', '`"oak"`, `"pine"`')
    assert (hinges.default, hinges.allowed) == ("[1, 2]", "2 of: a whole number")
    rest, stiffness = spring.settings
    assert spring.path == "board.spring" and (rest.unit, stiffness.unit) == ("m", "N/m")
    assert stiffness.default == "500" and stiffness.allowed == "1 to 100000"
    assert stiffness.text == "the line beside it counts"


def test_every_default_of_a_deployment_can_be_written_as_it_is_shown(tmp_path):
    """A deployment file of all of them is the default deployment."""
    lines = []
    for section in sections(Deployment):
        if "[]" in section.path or section.path.startswith("network.hosts"):
            continue
        lines += [f"[{section.path}]"] if section.path else []
        lines += [f"{each.name} = {each.default}" for each in section.settings if each.default]
    file = tmp_path / "all.toml"
    file.write_text("\n".join(lines))
    assert load_deployment(file) == Deployment()


def test_every_section_of_a_deployment_is_on_the_page():
    page = settings_page()
    assert all(f"### `{each.path}`" in page for each in sections(Deployment) if each.path)
    assert "| `step_m` | `0.1` | 0.001 to 0.5 | m |" in page
    assert as_toml((0.5, "a", True)) == '[0.5, "a", true]'
