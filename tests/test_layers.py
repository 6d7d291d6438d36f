"""Imports run one way: bus <- hw <- components <- tools; config imports none of them. Components are pure."""

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
ALLOWED = {
    "config": {"config"},
    "bus": {"bus", "config"},
    "hw": {"bus", "config", "hw"},
    "components": {"bus", "config", "components"},
    "tools": {"bus", "config", "components", "hw", "tools"},
}
SOURCES = sorted(path for room in ALLOWED for path in (ROOT / room).rglob("*.py"))


def imports(path):
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: relative imports hide the room they come from"
            yield node.module


@pytest.mark.parametrize("path", SOURCES, ids=lambda path: str(path.relative_to(ROOT)))
def test_a_room_imports_only_what_it_may(path):
    room = path.relative_to(ROOT).parts[0]
    allowed = set(ALLOWED[room])
    if path.parent == ROOT / "components" / "io":
        allowed.add("hw")  # the one component that touches the hardware
    for name in imports(path):
        if name.startswith("surefoot."):
            assert name.split(".")[1] in allowed, f"{path.relative_to(ROOT)} imports {name}"


@pytest.mark.parametrize("path", SOURCES, ids=lambda path: str(path.relative_to(ROOT)))
def test_no_controller_reads_the_simulators_truth(path):
    parts = path.relative_to(ROOT).parts
    if parts[0] == "components" and len(parts) > 2 and parts[1] != "io":
        assert "sim/truth" not in path.read_text()
        assert "foot_force" not in path.read_text(), "an emulator's foot sensors are the simulator's truth"


PURE = [path for path in SOURCES if path.parent.parent == ROOT / "components"]
IMPURE = {"time", "datetime", "random", "secrets", "os", "pathlib", "socket", "threading", "subprocess"}


@pytest.mark.parametrize("path", PURE, ids=lambda path: str(path.relative_to(ROOT)))
def test_a_component_has_no_clock_no_file_and_no_chance(path):
    """What a component publishes follows from its inbox; a stopwatch for its own status is allowed."""
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            assert not IMPURE & {alias.name.split(".")[0] for alias in node.names}, ast.unparse(node)
        elif isinstance(node, ast.ImportFrom) and node.module.split(".")[0] in IMPURE:
            assert {alias.name for alias in node.names} == {"perf_counter"}, ast.unparse(node)
        elif isinstance(node, ast.Attribute):
            assert node.attr != "random", ast.unparse(node)
        elif isinstance(node, ast.Name):
            assert node.id not in ("open", "print", "input"), ast.unparse(node)


DATES = {
    "bus/identity.py",
    "tools/commands/keys.py",
    "tools/keys.py",
    "tools/calibration/unit_file.py",
    "tools/recording/about.py",
}
"""Where a date of the calendar is meant: how long a certificate is valid, when a file was made."""

WALL_CLOCK = {
    "time": {"time", "time_ns", "localtime", "gmtime", "ctime", "asctime", "strftime", "CLOCK_REALTIME"},
    "datetime": {"now", "utcnow", "today"},
    "date": {"today"},
}


@pytest.mark.parametrize("path", SOURCES, ids=lambda path: str(path.relative_to(ROOT)))
def test_nothing_goes_by_the_clock_on_the_wall(path):
    """It may jump while a run goes on; `time.monotonic` and `time.perf_counter` do not."""
    if str(path.relative_to(ROOT)) in DATES:
        return
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.ImportFrom) and node.module == "time":
            assert not WALL_CLOCK["time"] & {alias.name for alias in node.names}, ast.unparse(node)
        elif isinstance(node, ast.Attribute):
            name = ast.unparse(node.value).rsplit(".", 1)[-1]
            assert node.attr not in WALL_CLOCK.get(name, ()), ast.unparse(node)
