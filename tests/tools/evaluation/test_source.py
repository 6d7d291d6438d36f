"""Two states of the program that may give different results have different digests; others have not."""

import pytest

from surefoot.tools.evaluation import source

MAKES = (
    "hw/mujoco/plant.py",
    "bus/topics.py",
    "config/fsm.py",
    "config/robots/any.toml",
    "tools/evaluation/grader.py",
)
READS = ("tools/screen.py", "tools/evaluation/summary.py", "tools/evaluation/marks.py", "config/planks.toml")


@pytest.fixture
def program(tmp_path, monkeypatch):
    for path in (*MAKES, *READS):
        (tmp_path / path).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / path).write_text("one")
    monkeypatch.setattr(source.surefoot, "__path__", [str(tmp_path)])
    return tmp_path


@pytest.mark.parametrize("path", MAKES)
def test_what_makes_results_is_in_the_digest(program, path):
    before = source.source_digest()
    (program / path).write_text("two")
    assert source.source_digest() != before
    (program / path).write_text("one")
    assert source.source_digest() == before


@pytest.mark.parametrize("path", READS)
def test_what_reads_them_is_not(program, path):
    before = source.source_digest()
    (program / path).write_text("two")
    assert source.source_digest() == before


def test_the_files_of_this_program_are_found():
    names = {path.name for path in source.sources()}
    assert {"backend.py", "fsm.py", "aliengo.toml", "one_run.py"} <= names
    assert not {"summary.py", "marks.py"} & names
