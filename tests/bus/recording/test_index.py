"""One topic is read without the others, of a whole file and of one that was cut off."""

import random

import pytest
import scenes

from surefoot.bus.errors import RecordingError
from surefoot.bus.recording.index import RecordingIndex
from surefoot.bus.recording.reader import Recording

CLIP = scenes.path("collapse")


def by_topic(path):
    found = {}
    for item in Recording(path):
        if not item.digest:
            found.setdefault(item.key, []).append(item)
    return found


def test_a_topic_holds_what_reading_the_whole_file_gives():
    index, whole = RecordingIndex(CLIP), by_topic(CLIP)
    assert index.counts == {key: len(items) for key, items in whole.items()}
    assert index.digests["mpc/policy"] > 50 and index.damage == ""
    for key, items in whole.items():
        assert list(index.messages(key)) == items
    assert list(index.messages("hw/depth")) == []


def test_some_topics_together_come_in_the_order_of_the_file():
    keys = ("fsm/event", "hw/state", "joint/command")
    expected = [item for item in Recording(CLIP) if item.key in keys and not item.digest]
    assert list(RecordingIndex(CLIP).messages(*keys)) == expected and len({item.key for item in expected}) > 1


def test_a_stretch_of_time_is_read_alone():
    index = RecordingIndex(CLIP)
    begin, end = 23_400_000_000, 23_500_000_000
    inside = [item for item in index.messages("hw/state") if begin <= item.t_ns <= end]
    assert len(inside) == 51 and list(index.messages("hw/state", first_ns=begin, last_ns=end)) == inside
    assert index.span_ns == (21_202_000_000, 23_940_000_000)


def test_a_file_that_is_cut_off_anywhere_gives_what_came_before(tmp_path):
    whole, cut = CLIP.read_bytes(), tmp_path / "cut.mcap"
    for end in sorted(random.Random(0).sample(range(len(whole)), 40)):
        cut.write_bytes(whole[:end])
        try:
            expected = by_topic(cut)
        except RecordingError:
            with pytest.raises(RecordingError):
                RecordingIndex(cut)
            continue
        index = RecordingIndex(cut)
        assert index.damage != "" and index.journals() == []
        assert index.counts == {key: len(items) for key, items in expected.items()}
        assert {key: list(index.messages(key)) for key in expected} == expected


def test_a_byte_that_was_changed_ends_a_topic_and_is_told(tmp_path):
    damaged = bytearray(CLIP.read_bytes())
    damaged[len(damaged) // 2] ^= 0xFF
    path = tmp_path / "damaged.mcap"
    path.write_bytes(damaged)
    index = RecordingIndex(path)
    read = sum(len(list(index.messages(key))) for key in index.counts)
    assert read < sum(index.counts.values()) and "cannot be read from" in index.damage


@pytest.mark.parametrize("content", [b"", b"not a recording", b"\x89MCAP0\r\n"])
def test_another_file_is_refused(tmp_path, content):
    path = tmp_path / "a.mcap"
    path.write_bytes(content)
    with pytest.raises(RecordingError, match="not a recording"):
        RecordingIndex(path)
