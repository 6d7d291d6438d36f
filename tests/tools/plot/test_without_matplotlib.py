"""Without the package that draws, the command names the one that brings it."""

import subprocess
import sys

import pytest
import scenes

CALL = """
import sys
sys.modules["matplotlib"] = None
from surefoot.tools.cli import main
sys.exit(main(sys.argv[1:]))
"""


@pytest.mark.parametrize("words", [["plot", "--out", "a.png"], ["report", "--out", "a.html"]])
def test_the_remedy_is_named(words, tmp_path):
    call = [sys.executable, "-P", "-c", CALL, words[0], str(scenes.path("stand")), *words[1:]]
    told = subprocess.run(call, cwd=tmp_path, capture_output=True, text=True)
    assert told.returncode == 2 and "pip install 'surefoot[report]'" in told.stderr
    assert list(tmp_path.iterdir()) == []
