"""Notices that source files have changed, and says which processes are made of them."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from hashlib import sha1
from pathlib import Path

from surefoot.tools.reload.import_graph import ImportGraph, imports_of, source_files

ROOT = Path(__file__).resolve().parents[2]
"""Where the folders of the package lie."""

_ORDER = ("wbc", "mpc", "fsm", "trajopt", "elevation_map", "estimator")
"""Readers before their writers: one that comes up asks its writers for their last messages."""

_POLL_S = 0.5
_NAMED = 3


@dataclass(frozen=True)
class Change:
    """What has to be done about changed files.

    Attributes:
        what: the files, in words.
        processes: to be restarted, in this order.
        notes: what there is to say besides.
    """

    what: str
    processes: tuple[str, ...]
    notes: tuple[str, ...]


class SourceWatch:
    """Looks at the times of all source files every now and then.

    A change counts when the files have been left alone from one look to the next, when their content is another
    than what runs, and when all of them compile.
    """

    def __init__(self, root: Path = ROOT, clock: Callable[[], float] = time.monotonic):
        """What lies under `root` now is what runs."""
        self._root, self._clock = root, clock
        self._stamps = self._look()
        self._settled = True
        self._running: dict[str, _Source] = {}
        for path in self._stamps:
            source = _Source(root / path)
            source.fault = ""  # it was imported, or nobody needs it
            self._running[path] = source
        self._graph = ImportGraph({path: source.imports for path, source in self._running.items()})
        self._faults = ""
        self._next = clock() + _POLL_S

    def changed(self) -> Change | None:
        """What has changed since the last change; None when nothing has, or not for good."""
        if self._clock() < self._next:
            return None
        self._next = self._clock() + _POLL_S
        stamps = self._look()
        if stamps != self._stamps:
            self._stamps, self._settled = stamps, False
            return None
        if self._settled:
            return None
        self._settled = True
        return self._judge()

    def _judge(self) -> Change | None:
        """The files are at rest: what they mean."""
        sources = {path: _Source(self._root / path) for path in self._stamps}
        paths = _differing(self._running, sources)
        faults = [f"{path}, {source.fault}" for path, source in sources.items() if path in paths and source.fault]
        if faults:
            words = f"nothing is restarted: {'; '.join(faults[:_NAMED])}"
            said, self._faults = self._faults, words
            return None if words == said else Change("", (), (words,))
        self._faults = ""
        if not paths:
            return None
        graph = ImportGraph({path: source.imports for path, source in sources.items()})
        # One that no longer imports a file has it loaded all the same.
        names = self._graph.processes_with(paths) | graph.processes_with(paths)
        self._running, self._graph = sources, graph
        what = _names(paths)
        notes = []
        if "io" in names:
            notes.append(
                f"io goes on with what {what} said before: it holds the robot and the bus and cannot be restarted"
            )
        if not names:
            notes.append(f"{what} changed: no process is made of it, the next run will be")
        return Change(what, tuple(name for name in _ORDER if name in names), tuple(notes))

    def _look(self) -> dict[str, tuple[int, int]]:
        """Time of the last change [ns] and size [bytes] of every source file."""
        stamps = {}
        for path in source_files(self._root):
            try:
                found = (self._root / path).stat()
            except FileNotFoundError:
                continue  # an editor is replacing it
            stamps[path] = found.st_mtime_ns, found.st_size
        return stamps


class _Source:
    """One file as it was read.

    Attributes:
        digest: of its bytes.
        imports: what it imports of the package.
        fault: why it does not compile; empty if it does.
    """

    def __init__(self, path: Path):
        self.fault, self.imports = "", frozenset[str]()
        try:
            text = path.read_bytes()
        except FileNotFoundError:
            text = b""
        self.digest = sha1(text).digest()
        try:
            compile(text, str(path), "exec", dont_inherit=True)
            self.imports = imports_of(text.decode())
        except (SyntaxError, ValueError) as error:
            where = f"line {error.lineno}: " if isinstance(error, SyntaxError) and error.lineno else ""
            self.fault = f"{where}{error.msg if isinstance(error, SyntaxError) else error}"


def _differing(before: dict[str, _Source], now: dict[str, _Source]) -> set[str]:
    """Files that are new, gone, or of another content."""
    return {
        path
        for path in before.keys() | now.keys()
        if path not in before or path not in now or before[path].digest != now[path].digest
    }


def _names(paths: set[str]) -> str:
    """Some of the files, and how many more."""
    named = sorted(paths)
    more = f" and {len(named) - _NAMED} more" if len(named) > _NAMED else ""
    return ", ".join(named[:_NAMED]) + more
