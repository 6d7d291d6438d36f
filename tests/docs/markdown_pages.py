"""The pages as their readers see them: blocks of code, code in the text, links, and the commands in all of it."""

import re
import shlex
from dataclasses import dataclass
from pathlib import Path

from markdown_it import MarkdownIt

ROOT = Path(__file__).resolve().parents[2]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
NAMES = [str(page.relative_to(ROOT)) for page in PAGES]

_MARKDOWN = MarkdownIt("commonmark").enable("table")
_ENDS = frozenset({"|", "||", "&", "&&", ";"})
_BEFORE = re.compile(r"sudo|\S*python|-P|-m|pdb|\S*/bin/surefoot")


@dataclass(frozen=True)
class Block:
    """Code on lines of its own; `kind` is what stands behind its fence."""

    kind: str
    text: str


def blocks(page):
    """The blocks of code of a page."""
    tokens = _MARKDOWN.parse(page.read_text())
    return [Block(token.info, token.content) for token in tokens if token.type in ("fence", "code_block")]


def spans(page):
    """The code inside the text of a page."""
    return [each.content for each in _inside(page) if each.type == "code_inline"]


def links(page):
    """Where the links and pictures of a page point to."""
    found = [each.attrs.get("href") or each.attrs.get("src") for each in _inside(page) if each.attrs]
    return [target for target in found if target]


def calls(line):
    """What follows `surefoot` in a line of a shell, for each time it is called there."""
    found = []
    for words in simple_commands(line):
        rest = list(words)
        while rest and _BEFORE.fullmatch(rest[0]) and rest[0] != "surefoot":
            program = rest.pop(0)
            if program.endswith("/bin/surefoot"):
                rest.insert(0, "surefoot")
        if rest and rest[0] in ("surefoot", "surefoot.tools.cli"):
            found.append(rest[1:])
    return found


def simple_commands(line):
    """The words of each command of a line: pipes and lists taken apart, comments and redirections left out."""
    lexer = shlex.shlex(line, posix=True, punctuation_chars="|&;<>")
    lexer.whitespace_split = True
    commands = [[]]
    words = iter(lexer)
    for word in words:
        if word in _ENDS:
            commands.append([])
        elif set(word) <= {"<", ">"}:
            next(words)
        else:
            commands[-1].append(word)
    return [words for words in commands if words]


def _inside(page):
    for token in _MARKDOWN.parse(page.read_text()):
        yield from token.children or ()
