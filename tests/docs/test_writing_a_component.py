"""The component of the page, written as the page says, is one: in the tables, in a run, in its own test."""

import pytest
from followed import Followed
from markdown_pages import ROOT

IN_A_RUN = """
import numpy as np
from surefoot.components.lockstep import Lockstep
from surefoot.config.deployment import load_deployment

lockstep, heard = Lockstep(load_deployment("config/flat.toml", ["load_watch.share_max=0.3"])), []
lockstep.listen(lambda key, message: heard.append(message) if key == "load/share" else None)
lockstep.command("stand")
lockstep.run(1.0)
assert 40 <= len(heard) <= 50, len(heard)
assert abs(heard[-1].share.sum() - 1.0) < 0.1, heard[-1].share
assert np.all(heard[-1].peak >= heard[-1].share)
"""


@pytest.fixture(scope="module")
def tree(tmp_path_factory):
    """The tree with `load_watch`."""
    return Followed(tmp_path_factory.mktemp("tree"), ROOT / "docs" / "writing_a_component.md")


def test_its_own_test_passes(tree):
    said = tree.python("-m", "pytest", "-q", "-p", "no:cacheprovider", "tests/components/load_watch")
    assert "3 passed" in said


def test_it_steps_in_a_run(tree):
    tree.python("-c", IN_A_RUN)


def test_it_is_in_every_table(tree):
    assert "load/share" in tree.surefoot("topics")
    tree.python(
        "-c",
        "from surefoot.bus.topics import PROCESSES; from surefoot.config.network import COMPONENTS\n"
        "from surefoot.tools.supervisor import _STOP_ORDER; from surefoot.tools.faults.safe_state import WORDS\n"
        "from surefoot.tools.reload.source_watch import _ORDER\n"
        "assert tuple(PROCESSES) == COMPONENTS\n"
        "assert set(PROCESSES) == set(_STOP_ORDER) == {*_ORDER, 'io'} == set(WORDS)",
    )
