"""`surefoot run --reload` on a copy of the project: a change of a source file restarts what is made of it."""

import os
import shutil
from pathlib import Path

import pytest

from surefoot.tools.reload.import_graph import ROOMS

ROOT = Path(__file__).parents[2]


@pytest.fixture
def tree(tmp_path):
    """A copy of the project that a test may change."""
    root = tmp_path / "tree"
    for room in ROOMS:
        shutil.copytree(ROOT / room, root / room, ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copytree(ROOT / ".import", root / ".import", symlinks=True)
    return root


def test_a_change_restarts_what_is_made_of_it_and_a_fault_waits_for_the_next(supervised, tree):
    env = {**os.environ, "PYTHONPATH": str(tree / ".import")}
    live = supervised("run.command=stand", flags=("--reload",), env=env)
    live.wait(lambda: live.t() > 0.5)

    def boots():
        return {name: status.boot for name, status in live.status.items() if status.boot}

    (tree / "components/mpc/mpc.py").open("a").write("# changed\n")
    live.wait(lambda: boots() == {"mpc": 1})
    live.go_on(0.2)
    assert boots() == {"mpc": 1} and "mpc restarted after a change of components/mpc/mpc.py" in live.said()

    wbc = tree / "components/wbc/wbc.py"
    text = wbc.read_text()
    wbc.write_text(f"{text}def (\n")
    line = len(text.splitlines()) + 1
    live.wait(lambda: f"nothing is restarted: components/wbc/wbc.py, line {line}: " in live.said())
    live.go_on(0.2)
    assert boots() == {"mpc": 1}

    wbc.write_text(f"{text}raise ValueError('boo')\n")
    live.wait(lambda: "wbc ended with exit code 1 (ValueError: boo)" in live.said())
    told, code = live.asked()
    assert code == 1 and "wbc, which ended with exit code 1 (ValueError: boo)" in told["why"]
    wbc.write_text(f"{text}# mended\n")
    live.wait(lambda: boots() == {"mpc": 1, "wbc": 2})
    live.go_on(0.2)

    (tree / "hw/gate/gate.py").open("a").write("# changed\n")
    live.wait(lambda: "io goes on with what hw/gate/gate.py said before" in live.said())
    live.go_on(0.2)
    assert live.stands() and live.asked()[1] == 0
    assert not any(status.bad_messages for status in live.status.values())
