"""Every message that the page explains is one that the program says."""

import ast
import re
from functools import cache

import pytest
from markdown_pages import ROOT

PAGE = (ROOT / "docs" / "troubleshooting.md").read_text()
MESSAGES = re.findall(r"^\| `([^`]+)` \|", PAGE, re.MULTILINE)


@cache
def said():
    """All texts in the program, what is put into them at run time left out as …"""
    texts = []
    for room in ("bus", "components", "config", "hw", "tools"):
        for path in (ROOT / room).rglob("*.py"):
            for node in ast.walk(ast.parse(path.read_text())):
                if isinstance(node, ast.Constant) and isinstance(node.value, str):
                    texts.append(node.value)
                elif isinstance(node, ast.JoinedStr):
                    parts = (part.value if isinstance(part, ast.Constant) else "…" for part in node.values)
                    texts.append("".join(parts))
    return texts


@pytest.mark.parametrize("message", MESSAGES)
def test_the_program_says_it(message):
    pieces = [re.escape(piece) for piece in message.split("…") if piece.strip()]
    pattern = re.compile(".*".join(pieces), re.DOTALL)
    assert any(pattern.search(text) for text in said()), "no such text in the source"


def test_there_are_messages():
    assert len(MESSAGES) > 40
