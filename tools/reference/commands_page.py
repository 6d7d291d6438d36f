"""The page of every command's help."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from functools import partial

_WIDTH = 100


def commands(parser: argparse.ArgumentParser) -> Iterator[argparse.ArgumentParser]:
    """The parsers of all commands, those of a command's own verbs in its place."""
    inner = [action for action in parser._actions if isinstance(action, argparse._SubParsersAction)]
    if not inner:
        yield parser
    for action in inner:
        for each in dict.fromkeys(action.choices.values()):
            yield from commands(each)


def commands_page(parser: argparse.ArgumentParser) -> str:
    """Markdown: what `--help` says of each command, in the order of the help."""
    return "\n\n".join(f"## `{each.prog}`\n\n```text\n{_help(each)}```" for each in commands(parser))


def _help(parser: argparse.ArgumentParser) -> str:
    parser.formatter_class = partial(parser.formatter_class, width=_WIDTH)  # type: ignore[call-arg]
    return parser.format_help()
