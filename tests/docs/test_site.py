"""The pages make a site without a warning, and every link in them leads somewhere, in the repository too."""

import re

import pytest
from followed import PLACE
from markdown_pages import NAMES, PAGES, ROOT, blocks, links, spans
from sphinx.cmd.build import build_main

from surefoot.bus.topics import TOPICS
from surefoot.tools.cli import COMMANDS

FILE = re.compile(r"(?:bus|components|config|docs|hw|tests|tools)/(?:[\w/.]*\.(?:py|toml|md|png|mcap)|[\w/]*/)")


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    """The built site; a page that is in no toctree, a dead link and a bad heading are errors."""
    out = tmp_path_factory.mktemp("site")
    code = build_main(["-n", "-W", "--keep-going", "-q", "-d", str(out / "trees"), str(ROOT / "docs"), str(out)])
    assert code == 0, "make docs tells why"
    return out


def test_every_page_is_in_it(site):
    for page in PAGES[1:]:
        assert (site / f"{page.stem}.html").is_file()


def test_what_is_in_the_code_is_in_it(site):
    topics = (site / "reference_topics.html").read_text()
    assert all(topic.message.__name__ in topics for topic in TOPICS.values())
    assert "swing_height_m" in (site / "reference_settings.html").read_text()
    commands = (site / "reference_commands.html").read_text()
    assert all(f"surefoot {each.__name__.rpartition('.')[2]}" in commands for each in COMMANDS)


@pytest.mark.parametrize("page", PAGES, ids=NAMES)
def test_every_link_leads_to_a_file(page):
    for target in links(page):
        if not re.match(r"[a-z]+:|#", target):
            assert (page.parent / target.partition("#")[0]).exists(), target


@pytest.mark.parametrize("page", PAGES, ids=NAMES)
def test_every_file_in_the_text_exists(page):
    made = {place["path"] for block in blocks(page) if (place := PLACE.match(block.text))}
    for span in spans(page):
        if FILE.fullmatch(span) and span not in made and not re.search(r"[A-Z]{3}", span):
            assert (ROOT / span).exists(), span
