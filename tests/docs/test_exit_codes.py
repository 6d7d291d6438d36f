"""The exit codes are those of the page."""

import re

import pytest
from markdown_pages import ROOT

from surefoot.tools.cli import main, make_parser
from surefoot.tools.commands import topics


def test_the_page_and_the_help_tell_the_same_codes():
    section = (ROOT / "docs" / "reference_commands.md").read_text().split("## Exit codes")[1].split("##")[0]
    told = re.findall(r"^\| (\d+) \|", section, re.MULTILINE)
    assert told == ["0", "1", "2", "130"]
    assert re.findall(r"(?:exit code: |; )(\d+) ", " ".join(make_parser().format_help().split())) == told


def test_0_it_is_done():
    assert main(["topics"]) == 0


def test_1_something_is_missing(tmp_path):
    """A recording whose recorder was killed."""
    cut = tmp_path / "cut.mcap"
    cut.write_bytes((ROOT / "tests" / "recordings" / "stand.mcap").read_bytes()[:-2000])
    assert main(["info", str(cut)]) == 1


def test_2_the_call_was_wrong_or_there_is_nothing_to_do_it_with():
    assert main(["run", "nowhere.toml"]) == 2
    assert main(["status", "--once", "--namespace", "nobody-is-there"]) == 2
    with pytest.raises(SystemExit) as wrong:
        main(["run", "--nonsense"])
    assert wrong.value.code == 2


def test_130_it_was_broken_off(monkeypatch):
    def interrupted(call):
        raise KeyboardInterrupt

    monkeypatch.setattr(topics, "_run", interrupted)
    assert main(["topics"]) == 130
