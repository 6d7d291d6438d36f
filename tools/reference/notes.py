"""What the source says beside the fields of a class, where Python itself forgets it."""

from __future__ import annotations

import ast
import inspect
import io
import re
import sys
import textwrap
import tokenize
from dataclasses import dataclass, is_dataclass
from functools import cache

_ATTRIBUTE = re.compile(r"^(\w+(?:, \w+)*): (.+)$")


@dataclass(frozen=True)
class Note:
    """Of one field.

    Attributes:
        text: its comment, the docstring below it, or its line under "Attributes" in the class's docstring.
        group: the comment line that heads it and the fields after it; empty where none does.
    """

    text: str = ""
    group: str = ""


def notes(cls: type) -> dict[str, Note]:
    """The notes of a class's fields, those of its bases included."""
    found: dict[str, Note] = {}
    for each in reversed(cls.__mro__):
        if is_dataclass(each):
            found |= _own_notes(each)
    return found


def summary(cls: type) -> str:
    """The docstring of a class without its list of attributes; one paragraph a line."""
    text = re.split(r"\n\s*Attributes:\n", inspect.cleandoc(cls.__doc__ or ""))[0]
    return "\n\n".join(" ".join(paragraph.split()) for paragraph in re.split(r"\n\s*\n", text))


def members(cls: type) -> dict[str, str]:
    """The docstrings below the members of an enumeration; empty where there is none."""
    body = _class(cls).body
    texts = {}
    for this, following in zip(body, [*body[1:], None], strict=True):
        if isinstance(this, ast.Assign) and isinstance(this.targets[0], ast.Name):
            texts[this.targets[0].id] = _docstring(following)
    return texts


def _own_notes(cls: type) -> dict[str, Note]:
    body = _class(cls).body
    lines, comments = _source(cls.__module__).splitlines(), _comments(cls.__module__)
    told, group, found = _attributes(cls), "", {}
    for number, this in enumerate(body):
        if not (isinstance(this, ast.AnnAssign) and isinstance(this.target, ast.Name)):
            continue
        beside = [comments[n] for n in range(this.lineno, (this.end_lineno or this.lineno) + 1) if n in comments]
        above, first = _above(this.lineno, lines, comments)
        previous = body[number - 1] if number else None
        heads = bool(above) and isinstance(previous, ast.AnnAssign) and not lines[first - 2].strip()
        if heads:
            group, above = above, ""
        text = " ".join(beside) or above or told.get(this.target.id, "")
        found[this.target.id] = Note(text, group)
    return found


def _above(lineno: int, lines: list[str], comments: dict[int, str]) -> tuple[str, int]:
    """The comment lines directly above a line, joined, and the number of the first of them."""
    first = lineno
    while lines[first - 2].lstrip().startswith("#"):
        first -= 1
    return " ".join(comments[n] for n in range(first, lineno)), first


def _attributes(cls: type) -> dict[str, str]:
    """Each name under "Attributes" in the docstring with its text."""
    _, _, listed = inspect.cleandoc(cls.__doc__ or "").partition("\nAttributes:\n")
    found: dict[str, str] = {}
    names: list[str] = []
    for line in textwrap.dedent(listed).splitlines():
        match = _ATTRIBUTE.match(line)
        if match:
            names = match[1].split(", ")
            found |= dict.fromkeys(names, match[2])
        elif line.startswith(" "):
            found |= {name: f"{found[name]} {line.strip()}" for name in names}
    return found


def _docstring(node: ast.stmt | None) -> str:
    if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str):
        return " ".join(node.value.value.split())
    return ""


def _class(cls: type) -> ast.ClassDef:
    tree = ast.parse(_source(cls.__module__))
    return next(node for node in tree.body if isinstance(node, ast.ClassDef) and node.name == cls.__name__)


@cache
def _source(module: str) -> str:
    return inspect.getsource(sys.modules[module])


@cache
def _comments(module: str) -> dict[int, str]:
    """The comment of each line that has one."""
    tokens = tokenize.generate_tokens(io.StringIO(_source(module)).readline)
    return {
        token.start[0]: token.string.lstrip("# ").rstrip() for token in tokens if token.type == tokenize.COMMENT
    }
