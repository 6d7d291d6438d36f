"""A recording at any instant: found without reading it all, also when it was cut off."""

import numpy as np
import pytest
import scenes

from surefoot.bus.codec import decode, encode
from surefoot.bus.errors import RecordingError
from surefoot.bus.recording.index import RecordingIndex as Index
from surefoot.bus.recording.reader import Recording
from surefoot.bus.recording.writer import RecordingWriter
from surefoot.bus.topics import TOPICS
from surefoot.tools.cli import main
from surefoot.tools.view.history import RARE
from surefoot.tools.view.recording_index import RecordingIndex
from surefoot.tools.view.recording_source import RecordingSource

CLIP = scenes.path("probe_holds")


def messages_of(index, key):
    return [each for _, each in index.messages(key, after_t=index.begin_t - 1.0, until_t=index.end_t)]


def test_the_newest_message_of_every_topic_is_found_at_every_instant():
    index = RecordingIndex(CLIP)
    read = {}
    for item in Recording(CLIP):
        if item.key in TOPICS and not item.digest:
            read.setdefault(item.key, []).append(decode(TOPICS[item.key].message, item.payload))
    assert len(messages_of(index, "mpc/policy")) == 1  # of the others the clip holds digests
    for key, messages in read.items():
        assert [each.seq for each in messages_of(index, key)] == [each.seq for each in messages]
        for t in np.linspace(index.begin_t, index.end_t, 40):
            expected = [each for each in messages if each.t <= t + 1e-9]
            found = index.newest(key, t)
            assert (found is None) == (not expected)
            assert found is None or encode(found) == encode(expected[-1])


def test_the_same_message_is_the_same_object():
    index = RecordingIndex(CLIP)
    assert index.newest("fsm/event", 7.5) is index.newest("fsm/event", 7.5)


def test_nothing_is_read_that_is_not_shown(tmp_path):
    """A file of gigabytes is open at once: what lies in its middle does not matter until it is looked at."""
    path, clip = tmp_path / "a.mcap", Index(CLIP)
    rare = {part.offset for key in RARE for part in clip.parts(key)}
    hidden = next(part for part in clip.parts("state/estimate")[1:-1] if part.offset not in rare)
    inside = [each.t_ns for each in clip.unpack(hidden) if each.key == "state/estimate"]
    content = bytearray(CLIP.read_bytes())
    content[hidden.offset : hidden.offset + 1000] = b"\xff" * 1000
    path.write_bytes(content)
    source = RecordingSource(path)
    source.seek(source.end_t)
    assert source.words == "" and source.heard.estimate is not None
    source.seek(inside[len(inside) // 2] / 1e9)
    assert "a part cannot be read" in source.words


def test_a_recording_that_was_cut_off_is_shown_up_to_its_end_and_says_so(tmp_path):
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(CLIP.read_bytes()[: 3 * CLIP.stat().st_size // 5])
    whole, source = RecordingSource(CLIP), RecordingSource(cut)
    assert "incomplete" in source.words and whole.words == ""
    assert whole.begin_t == source.begin_t < source.end_t <= whole.end_t
    source.seek(source.end_t)
    assert source.heard.estimate is not None


@pytest.mark.parametrize(
    ("content", "told"),
    [(None, "no such file"), (b"", "not a recording"), (b"words and words", "not a recording")],
)
def test_what_cannot_be_shown_is_told_in_a_line(tmp_path, capsys, content, told):
    path = tmp_path / "x.mcap"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(RecordingError, match=told):
        RecordingSource(path)
    assert main(["view", str(path), "--port", "0"]) == 2
    assert told in capsys.readouterr().err


def test_time_goes_to_where_it_is_put_and_history_with_it():
    source = RecordingSource(CLIP, from_t=7.9)
    later = len(source.heard.history.spots)
    source.seek(7.1)
    assert source.heard.t == pytest.approx(7.1, abs=0.01) and len(source.heard.history.spots) < later
    source.seek(99.0)
    assert source.t == source.end_t and len(source.heard.history.spots) == later


def test_it_leaps_from_verdict_to_verdict():
    source = RecordingSource(CLIP, from_t=7.2)
    source.leap(ahead=True)
    accepted = next(each for each in source.heard.history.events if each.kind == "accepted")
    assert source.t == accepted.t
    source.leap(ahead=True)  # there is no other
    assert source.t == accepted.t
    source.seek(source.end_t)
    source.leap(ahead=False)
    assert source.t == accepted.t


def test_it_plays_to_its_end_and_rests_there():
    source = RecordingSource(CLIP)
    source.speed = 1e6
    source.look()
    source.look()
    assert source.t == source.end_t and not source.playing


def test_an_event_that_cannot_be_read_is_told_and_the_rest_is_shown(tmp_path):
    path, recording = tmp_path / "odd.mcap", Recording(CLIP)
    writer = RecordingWriter(path, recording.about)
    for item in recording:
        payload = b"\x00" if item.key == "fsm/event" else item.payload
        if not item.digest:
            writer.add_record((item.key, item.t_ns, item.seq, payload))
    writer.close()
    source = RecordingSource(path)
    source.seek(source.end_t)
    source.leap(ahead=True)
    assert source.heard.estimate is not None and "FsmEvent" in source.words
