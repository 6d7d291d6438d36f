"""A copy of the tree in which a page's blocks have been carried out, as their reader would."""

import os
import re
import shutil
import subprocess
import sys

from markdown_pages import ROOT, blocks

ROOMS = ("bus", "components", "config", "hw", "tools", ".import")
PLACE = re.compile(r"# (?P<path>[\w/.]+)(?P<append>, at the end)?\n")


class Followed:
    """What the tree has become.

    Attributes:
        root: of the copy.
    """

    def __init__(self, root, page):
        """Copy the tree into a new folder and follow a page: new files, what is added at an end, and diffs."""
        self.root = root
        for room in ROOMS:
            shutil.copytree(ROOT / room, root / room, symlinks=True, ignore=shutil.ignore_patterns("__pycache__"))
        for block in blocks(page):
            place = PLACE.match(block.text)
            if block.kind == "diff":
                self._patch(block.text)
            elif place is not None:
                path, text = root / place["path"], block.text[place.end() :]
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_text(path.read_text() + text if place["append"] else text)

    def python(self, *words):
        """Run the copy's Python; what it printed."""
        env = os.environ | {"PYTHONPATH": str(self.root / ".import")}
        call = [sys.executable, "-P", *words]
        done = subprocess.run(call, cwd=self.root, env=env, capture_output=True, text=True)
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout

    def surefoot(self, *words):
        """Run the copy's command."""
        return self.python("-m", "surefoot.tools.cli", *words)

    def _patch(self, text):
        call = ["git", "apply", "--recount", "--unidiff-zero", "-"]
        done = subprocess.run(call, cwd=self.root, input=text, capture_output=True, text=True)
        assert done.returncode == 0, f"{done.stderr}\n{text}"
