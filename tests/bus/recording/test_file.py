"""A recording gives back what was written, whole or cut off anywhere."""

import json
import random

import pytest
from mcap.reader import make_reader

from surefoot.bus.codec import encode
from surefoot.bus.errors import RecordingError
from surefoot.bus.messages import OperatorCommand
from surefoot.bus.recording.journal import Batch
from surefoot.bus.recording.json_schema import json_schema
from surefoot.bus.recording.reader import Recording
from surefoot.bus.recording.writer import DIGEST, RecordingWriter, message_type
from surefoot.bus.topics import TOPICS

ABOUT = {"config": json.dumps({"robot": "aliengo"}), "version": "0"}


def payload(seq):
    return encode(OperatorCommand(t=0.1 * seq, seq=seq, valid=True, command="stand"))


def write(path, count, close=True, small=False):
    writer = RecordingWriter(path, ABOUT, small)
    for seq in range(count):
        last = seq == count - 1
        writer.add(Batch("operator", 0, seq, last, [("operator/command", seq * 10**8, seq, payload(seq))]))
        if seq % 10 == 9:
            writer.flush()
    writer.close() if close else writer.abandon()


def test_what_was_written_is_read(tmp_path):
    write(tmp_path / "a.mcap", 25)
    recording = Recording(tmp_path / "a.mcap")
    items = list(recording)
    assert [item.payload for item in items] == [payload(seq) for seq in range(25)]
    assert [(item.key, item.seq, item.t_ns) for item in items][3] == ("operator/command", 3, 3 * 10**8)
    assert recording.damage == "" and recording.config == {"robot": "aliengo"}
    assert recording.journals == [{"process": "operator", "boot": 0, "batches": 25, "ended": True}]


def test_a_small_file_gives_the_same_in_fewer_bytes(tmp_path):
    write(tmp_path / "a.mcap", 25)
    write(tmp_path / "small.mcap", 25, small=True)
    small = Recording(tmp_path / "small.mcap")
    assert [item.payload for item in small] == [item.payload for item in Recording(tmp_path / "a.mcap")]
    assert small.path.stat().st_size < (tmp_path / "a.mcap").stat().st_size


def test_a_file_that_was_not_closed_gives_all_that_was_flushed(tmp_path):
    write(tmp_path / "a.mcap", 25, close=False)
    recording = Recording(tmp_path / "a.mcap")
    assert len(list(recording)) == 20
    assert recording.damage != "" and recording.journals == []


def test_a_file_that_is_cut_off_anywhere_gives_what_came_before(tmp_path):
    write(tmp_path / "a.mcap", 50)
    whole = (tmp_path / "a.mcap").read_bytes()
    cut = tmp_path / "cut.mcap"
    for end in sorted(random.Random(0).sample(range(len(whole)), 60)):
        cut.write_bytes(whole[:end])
        try:
            items = list(Recording(cut))
        except RecordingError as error:
            assert end < 400, error  # before it has said what it is
            continue
        assert [item.payload for item in items] == [payload(seq) for seq in range(len(items))]
        assert len(items) % 10 == 0 or len(items) == 50


def test_a_byte_that_was_changed_loses_no_more_than_what_follows(tmp_path):
    write(tmp_path / "a.mcap", 50)
    whole = bytearray((tmp_path / "a.mcap").read_bytes())
    for at in range(500, len(whole), 97):
        changed = bytes([*whole[:at], whole[at] ^ 0x55, *whole[at + 1 :]])
        (tmp_path / "b.mcap").write_bytes(changed)
        list(Recording(tmp_path / "b.mcap"))


@pytest.mark.parametrize("content", [b"", b"text", b"\x89MCAP0\r\n"])
def test_another_file_is_refused(tmp_path, content):
    (tmp_path / "a.mcap").write_bytes(content)
    with pytest.raises(RecordingError, match="not a recording"):
        Recording(tmp_path / "a.mcap")
    with pytest.raises(RecordingError, match="no such file"):
        Recording(tmp_path / "b.mcap")


def test_other_readers_find_topics_schemas_and_an_index(tmp_path):
    write(tmp_path / "a.mcap", 25)
    with (tmp_path / "a.mcap").open("rb") as file:
        read = list(make_reader(file).iter_messages(topics=["operator/command"]))
    schema, channel, message = read[4]
    assert (schema.name, schema.encoding, channel.message_encoding) == ("OperatorCommand", "jsonschema", "msgpack")
    assert message.data == payload(4) and len(read) == 25


def test_messages_and_digests_of_a_topic_are_told_apart(tmp_path):
    writer = RecordingWriter(tmp_path / "a.mcap", ABOUT)
    writer.add_record(("operator/command", 0, 0, payload(0)))
    writer.add_record(("operator/command", 1, 1, b"12345678"), DIGEST)
    writer.close()
    assert [item.digest for item in Recording(tmp_path / "a.mcap")] == [False, True]


@pytest.mark.parametrize("key", [*TOPICS, "steps/mpc", "checkpoint/mpc"])
def test_the_schema_names_every_field_with_its_unit(key):
    schema = json.loads(json_schema(message_type(key)))
    assert schema["title"] == message_type(key).__name__
    assert {"t", "seq", "boot", "valid", "message"} <= schema["properties"].keys()
    assert schema["properties"]["t"]["unit"] == "s"


def test_a_schema_says_how_to_read_an_array():
    properties = json.loads(json_schema(TOPICS["mpc/policy"].message))["properties"]
    assert properties["x"]["shape"] == [-1, 24] and properties["x"]["dtype"] == "float64, little-endian"
