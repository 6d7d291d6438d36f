"""Which state of the program made a result."""

from __future__ import annotations

import hashlib
from pathlib import Path

import surefoot

_MAKES_RESULTS = ("bus/**/*.py", "components/**/*.py", "config/**/*.py", "hw/**/*.py", "tools/evaluation/*.py")
"""The programs that decide what a run gives; a deployment's own figures stand in `results.json`."""

_ROBOTS = "config/robots/*"
"""Of a robot only the name stands there."""

_READS_RESULTS = ("label_map.py", "marks.py", "pooled.py", "summary.py")
"""What looks at the runs only once they are there."""


def sources() -> list[Path]:
    """The files that decide what a run gives, in an order that is the same everywhere."""
    root = _root()
    found = {path for pattern in (*_MAKES_RESULTS, _ROBOTS) for path in root.glob(pattern) if path.is_file()}
    return sorted(path for path in found if path.name not in _READS_RESULTS)


def source_digest() -> str:
    """Digest of those files: runs of two states of the program do not belong into one results file."""
    digest = hashlib.sha256()
    for path in sources():
        digest.update(str(path.relative_to(_root())).encode() + b"\0" + path.read_bytes() + b"\0")
    return digest.hexdigest()[:16]


def _root() -> Path:
    return Path(next(iter(surefoot.__path__)))
