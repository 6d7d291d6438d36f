"""Which state of the program made a result."""

from __future__ import annotations

import hashlib
from pathlib import Path

import surefoot

_MAKES_RESULTS = ("bus", "components", "config", "hw", "tools/evaluation")
"""The folders whose content decides what a run gives."""


def source_digest() -> str:
    """Digest of the program's own files: runs of two versions of it do not belong into one file."""
    root = Path(next(iter(surefoot.__path__)))
    digest = hashlib.sha256()
    for folder in _MAKES_RESULTS:
        paths = [path for path in (root / folder).rglob("*") if path.suffix in (".py", ".toml", ".json")]
        for path in sorted(paths):
            digest.update(str(path.relative_to(root)).encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()[:16]
