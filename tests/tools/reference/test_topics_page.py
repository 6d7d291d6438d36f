"""The reference of topics says what the tables of the bus say."""

from surefoot.bus.message import specs
from surefoot.bus.topics import PROCESSES, TOPICS
from surefoot.tools.reference.topics_page import topics_page

PAGE = topics_page()


def test_every_topic_and_every_field_is_on_it():
    for topic in TOPICS.values():
        assert topic.key.startswith("status/") or f"| `{topic.key}` |" in PAGE
        assert f"### `{topic.message.__name__}`" in PAGE
        assert all(f"| `{name}` |" in PAGE for name in specs(topic.message))


def test_every_field_says_what_it_is():
    silent = [
        f"{t.message.__name__}.{n}" for t in TOPICS.values() for n, s in specs(t.message).items() if not s.doc
    ]
    assert not silent, "give them a doc in bus/messages.py"


def test_who_writes_and_who_reads():
    assert "| `mpc/policy` | [`Policy`](#policy) | mpc | wbc | 100 | 0.1 |" in PAGE
    assert all(f"| `{name}` |" in PAGE for name in PROCESSES)
    assert "every 2nd `state/estimate`" in PAGE and "COLLAPSING" in PAGE
