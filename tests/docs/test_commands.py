"""Every command that a page or a help shows is known to the parser; its deployments and settings exist."""

import re
from argparse import SUPPRESS, ArgumentParser, _SubParsersAction
from contextlib import redirect_stderr
from io import StringIO

import pytest
from markdown_pages import NAMES, PAGES, ROOT, blocks, calls, simple_commands, spans

from surefoot.config.deployment import Deployment, load_deployment
from surefoot.config.reproduce import Reproduce
from surefoot.config.typed_toml import build, with_override
from surefoot.tools.cli import make_parser
from surefoot.tools.commands.call import deployment_file, seeds
from surefoot.tools.completion import _WORDS as WORDS
from surefoot.tools.evaluation.arms import arm_overrides
from surefoot.tools.reference.commands_page import commands
from surefoot.tools.reference.settings import sections

PLACEHOLDER = re.compile(r"…|[A-Z][A-Z_]*(\.mcap)?|.*=[A-Z]")
SETTINGS = {f"{each.path}.{setting.name}" for each in sections(Deployment) for setting in each.settings}
SECTIONS = {each.path for each in sections(Deployment)}
COMMANDS = list(commands(make_parser()))
MADE = re.compile(r"^(?:# |cp \S+ )config/(?:robots/)?(\w+)\.toml$", re.MULTILINE)
READERS = {name for page in PAGES for block in blocks(page) for name in MADE.findall(block.text)}
"""Terrains and robots that a page has its reader make."""


def parsed(words, whole):
    """The call as the real parser takes it; what is only mentioned may leave out what must be given."""
    parser = make_parser()
    if not whole:
        relax(parser)
    with redirect_stderr(StringIO()) as said:
        try:
            return parser.parse_args(words)
        except SystemExit:
            pytest.fail(f"surefoot {' '.join(words)}: {said.getvalue().splitlines()[-1]}")


def relax(parser):
    for action in parser._actions:
        action.required = False
        if isinstance(action, _SubParsersAction):
            for inner in action.choices.values():
                relax(inner)
        elif action.nargs is None:
            action.nargs, action.type, action.default = "?", None, SUPPRESS
    for group in parser._mutually_exclusive_groups:
        group.required = False


def check(words, whole):
    """Fails where a word of the call could not be followed."""
    call = vars(parsed(words, whole))
    parser = next(
        (each for each in COMMANDS if each.prog.split()[1:] == words[: len(each.prog.split()) - 1]), None
    )
    files = [deployment for name in ("config", "scenario", "connect") for deployment in named(call.get(name))]
    given = [each for each in call.get("set") or () if not PLACEHOLDER.fullmatch(each)]
    changes = [each for each in given if not READERS & set(re.findall(r"\w+", each))]
    for file in files:
        load_deployment(file, changes if "arm" not in call else [*arm(call["arm"]), *changes])
    if words[0] == "reproduce":
        table = {}
        for change in changes:
            table = with_override(table, change)
        build(Reproduce, table)
    if call.get("seeds"):
        seeds(call["seeds"])
    for (prog, argument), known in WORDS.items():
        given = call.get(argument)
        word = given[0] if isinstance(given, list) and given else given
        if parser is not None and parser.prog == prog and word and not PLACEHOLDER.fullmatch(word):
            assert word in known, f"surefoot {' '.join(words)}"


def named(given):
    """The files of deployments that come with the project; a reader's own are not here."""
    names = given if isinstance(given, list) else [given] if isinstance(given, str) else []
    return [deployment_file(name) for name in names if not (PLACEHOLDER.fullmatch(name) or own(name))]


def own(name):
    return name in READERS or (name.endswith(".toml") and not name.startswith("config/"))


def arm(name):
    return [] if re.search(r"ARM|=[A-Z]", name) else arm_overrides(name)


def expanded(text):
    """The lines of a block, those that go on in the next one joined, shell variables put in."""
    variables = {}
    for line in text.replace("\\\n", " ").splitlines():
        assignment = re.fullmatch(r"\s*([A-Z]+)=\"(.*)\"", line)
        if assignment:
            variables[f"${assignment[1]}"] = assignment[2]
        for name, value in variables.items():
            line = line.replace(name, value)
        yield line


@pytest.mark.parametrize("page", PAGES, ids=NAMES)
def test_every_command_in_a_block_is_one(page):
    for block in blocks(page):
        if block.kind.split()[:1] not in ([], ["sh"]):
            continue
        for line in expanded(block.text):
            if re.search(r"(^|[\s/])surefoot [a-z]|surefoot\.tools\.cli", line):
                for words in calls(line):
                    check(words, whole=True)


@pytest.mark.parametrize("page", PAGES, ids=NAMES)
def test_every_command_in_the_text_is_one(page):
    for span in spans(page):
        if re.match(r"surefoot [a-z]", span):
            for words in calls(span):
                check(words, whole=False)


@pytest.mark.parametrize("page", PAGES, ids=NAMES)
def test_every_goal_of_make_is_one(page):
    known = set(re.findall(r"^([a-z]+):", (ROOT / "Makefile").read_text(), re.MULTILINE))
    shown = [
        line for block in blocks(page) for line in block.text.splitlines() if line.strip().startswith("make ")
    ]
    shown += [span for span in spans(page) if span.startswith("make ")]
    for line in shown:
        for words in simple_commands(line):
            if words[0] == "make":
                assert {word for word in words[1:] if "=" not in word} <= known, line


@pytest.mark.parametrize("page", PAGES, ids=NAMES)
def test_every_setting_in_the_text_is_one(page):
    for span in spans(page):
        name = re.match(r"(?:--set )?([a-z_]+(?:\.[a-z_0-9]+)+)(?= ?=|$)", span)
        if name and name[1].split(".")[0] in SECTIONS and not name[1].endswith((".py", ".toml", ".md")):
            assert name[1] in SETTINGS | SECTIONS, span


@pytest.mark.parametrize("parser", COMMANDS, ids=lambda parser: parser.prog)
def test_the_help_of_a_command_has_an_example_and_its_exit_codes(parser: ArgumentParser):
    said = parser.format_help()
    examples = re.split(r"\nexamples?:", said)[1:]
    assert examples, "no example"
    assert re.search(r"exit codes?: ", said), "no exit codes"
    shown = [words for line in examples[-1].splitlines() for words in calls(line)]
    assert any(words[: len(parser.prog.split()) - 1] == parser.prog.split()[1:] for words in shown), shown
    for words in shown:
        check(words, whole=True)
