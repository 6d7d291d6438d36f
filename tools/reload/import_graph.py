"""Which source files each process is made of: the import statements of the package, read without running it."""

from __future__ import annotations

import ast
from collections.abc import Mapping
from pathlib import Path, PurePosixPath

from surefoot.bus.topics import PROCESSES

PACKAGE = "surefoot"
ROOMS = ("bus", "components", "config", "hw", "tools")
"""Folders of the package's modules, under the project's root."""

_RUNNERS = {"io": ("components.clock_master", "components.runner")}
"""What steps a process besides its component; `components.runner` alone where nothing is said."""


class ImportGraph:
    """The modules of a tree and what they import; an import inside a function counts like any other."""

    def __init__(self, imports: Mapping[str, frozenset[str]]):
        """`imports`: for each file, relative to the root with slashes, the dotted names it imports."""
        self._files = {_module_of(path): path for path in imports}
        self._imports = {path: self._resolve(path, names) for path, names in imports.items()}

    def files_of(self, process: str) -> set[str]:
        """Every file that the named process may have loaded, relative to the root."""
        roots = (f"components.{process}.{process}", *_RUNNERS.get(process, ("components.runner",)))
        found: set[str] = set()
        todo = [path for root in roots for path in self._with_packages(root)]
        while todo:
            path = todo.pop()
            if path not in found:
                found.add(path)
                todo.extend(self._imports[path])
        return found

    def processes_with(self, paths: set[str]) -> set[str]:
        """The processes that are made of any of these files."""
        return {name for name in PROCESSES if not paths.isdisjoint(self.files_of(name))}

    def _resolve(self, path: str, names: frozenset[str]) -> set[str]:
        """The files behind dotted names; a name that is no module is something in one."""
        found: set[str] = set()
        for name in names:
            while name and name not in self._files:
                name = name.rpartition(".")[0]
            if name:
                found.update(self._with_packages(name))
        return found - {path}

    def _with_packages(self, module: str) -> list[str]:
        """The file of a module and of the packages around it, which are imported with it."""
        parts = module.split(".")
        dotted = (".".join(parts[:end]) for end in range(1, len(parts) + 1))
        return [self._files[name] for name in dotted if name in self._files]


def imports_of(source: str) -> frozenset[str]:
    """The dotted names, without the package's own, that a module of this package imports from it.

    Raises:
        SyntaxError: it is no Python.
    """
    found: set[str] = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            found.update(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            # What is imported from a package may be a module of it.
            found.update(f"{node.module}.{alias.name}" for alias in node.names)
    prefix = f"{PACKAGE}."
    return frozenset(name.removeprefix(prefix) for name in found if name.startswith(prefix))


def source_files(root: Path) -> list[str]:
    """Every module's file under the project's root, relative to it."""
    return sorted(path.relative_to(root).as_posix() for room in ROOMS for path in (root / room).rglob("*.py"))


def _module_of(path: str) -> str:
    """The dotted name of a file's module."""
    parts = PurePosixPath(path).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)
