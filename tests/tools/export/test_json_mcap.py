"""The JSON of a recording is what was recorded, in a file that Foxglove and PlotJuggler can read.

What they ask for stands in their sources: Lichtblick (the open branch of Foxglove), its converter of JSON schemas
and the indexed reader of `@mcap/core`; PlotJuggler, its `DataLoadMCAP` and its parser of JSON.
"""

import json
import re

import numpy as np
import pytest
import scenes
from mcap.opcode import Opcode
from mcap.reader import NonSeekingReader, SeekingReader
from mcap.records import Footer, SummaryOffset
from mcap.stream_reader import StreamReader

from surefoot.bus.codec import decode
from surefoot.bus.message import specs
from surefoot.bus.messages import ElevationGrid
from surefoot.bus.recording.reader import Recording
from surefoot.bus.topics import TOPICS
from surefoot.tools.cli import main
from surefoot.tools.export.foxglove_scene import SCHEMA_NAME, scene_schema
from surefoot.tools.export.json_shape import plain_json_schema, to_json

KINDS = {"number": (int, float, type(None)), "integer": int, "boolean": bool, "string": str}


@pytest.fixture(scope="module", params=["collapse", "map"])
def exported(request, tmp_path_factory):
    """(name of the clip, its export)."""
    out = tmp_path_factory.mktemp("json") / "a.mcap"
    assert main(["export", str(scenes.path(request.param)), "--to", "json-mcap", "--out", str(out)]) == 0
    return request.param, out


@pytest.fixture
def summary(exported):
    with exported[1].open("rb") as file:
        return SeekingReader(file, validate_crcs=True).get_summary()


def items_of(path, reader=SeekingReader):
    """(schema, channel, message) of all messages, every checksum looked at."""
    with path.open("rb") as file:
        yield from reader(file, validate_crcs=True).iter_messages()


def strict(data):
    """JSON without the words NaN and Infinity, at which both programs' parsers fail."""
    return json.loads(data, parse_constant=lambda word: pytest.fail(f"{word} is no JSON"))


# What was recorded --------------------------------------------------------------------------------------


def numbers_in(value):
    """The leaves of a value in JSON, in their order."""
    if isinstance(value, dict):
        value = list(value.values())
    return [leaf for each in value for leaf in numbers_in(each)] if isinstance(value, list) else [value]


def numbers_of(value):
    """The same of a field of a message; what is not finite is null."""
    flat = value.ravel().tolist() if isinstance(value, np.ndarray) else value
    return [None if each != each else each for each in (flat if isinstance(flat, list | tuple) else [flat])]


def test_every_message_is_there_number_for_number(exported):
    name, path = exported
    told: dict[str, list] = {}
    for _, channel, message in items_of(path):
        told.setdefault(channel.topic, []).append((message.log_time, strict(message.data)))
    assert {"state/estimate", "fsm/reference", "fsm/event"} <= told.keys() and "mpc/policy" not in told
    assert told.pop("scene")
    for key, messages in told.items():
        expected = [
            decode(TOPICS[key].message, item.payload)
            for item in Recording(scenes.path(name))
            if item.key == key and not item.digest
        ]
        for (log_time, fields), message in zip(messages, expected, strict=True):
            assert log_time == round(1e9 * message.t)
            assert fields.keys() == specs(type(message)).keys()
            assert all(numbers_in(value) == numbers_of(getattr(message, field)) for field, value in fields.items())


def test_places_with_names_are_found_by_them(exported):
    name, path = exported
    estimate = next(strict(item.data) for _, channel, item in items_of(path) if channel.topic == "state/estimate")
    recorded = next(item for item in Recording(scenes.path(name)) if item.key == "state/estimate")
    message = decode(TOPICS["state/estimate"].message, recorded.payload)
    assert estimate["p_WF"]["RL"]["z"] == message.p_WF[2, 2]
    assert estimate["q"]["FR_calf"] == message.q[5]
    assert estimate["quat_WB"]["w"] == message.quat_WB[0]
    assert estimate["covariance"][3]["row"][4] == message.covariance[3, 4]


def test_what_is_no_number_is_null():
    grid = ElevationGrid(height_m=np.array([[0.5, np.nan]], np.float32))
    assert strict(to_json(grid))["height_m"] == [{"row": [0.5, None]}]


def test_times_choose_what_is_exported(tmp_path):
    out, clip = tmp_path / "a.mcap", scenes.path("collapse")
    words = ("--to", "json-mcap", "--topics", "hw/state", "--from", "23.4", "--until", "23.5", "--out", str(out))
    assert main(["export", str(clip), *words]) == 0
    times = [message.log_time for _, _, message in items_of(out)]
    recorded = [item.t_ns for item in Recording(clip) if item.key == "hw/state"]
    assert times == [t_ns for t_ns in recorded if 23.4e9 <= t_ns <= 23.5e9]


# What Foxglove asks for ---------------------------------------------------------------------------------

SCHEMAS = {f"surefoot.{topic.message.__name__}": plain_json_schema(topic.message) for topic in TOPICS.values()}


@pytest.mark.parametrize("schema", [*SCHEMAS.values(), scene_schema()], ids=[*SCHEMAS, SCHEMA_NAME])
def test_foxglove_can_convert_the_schema_of_every_topic(schema):
    assert_convertible(strict(schema))


def assert_convertible(schema):
    """An object of plain values, objects, and lists of plain values or objects: never a list in a list."""
    assert schema["type"] == "object"
    for field in schema["properties"].values():
        inner = field["items"] if field["type"] == "array" else field
        assert {"oneOf", "contentEncoding"}.isdisjoint(inner)
        if inner["type"] == "object":
            assert_convertible(inner)
        else:
            assert inner["type"] in KINDS


def test_messages_are_as_their_schema_says(exported):
    for schema, channel, message in items_of(exported[1]):
        assert (channel.message_encoding, schema.encoding) == ("json", "jsonschema")
        assert fits(strict(message.data), json.loads(schema.data))


def fits(value, schema):
    if schema["type"] == "object":
        return value.keys() == schema["properties"].keys() and all(
            fits(value[name], inner) for name, inner in schema["properties"].items()
        )
    if schema["type"] == "array":
        lengths = schema.get("minItems", 0), schema.get("maxItems", len(value))
        return lengths[0] <= len(value) <= lengths[1] and all(fits(each, schema["items"]) for each in value)
    return isinstance(value, KINDS[schema["type"]])


def test_a_schema_keeps_unit_and_meaning():
    feet = strict(SCHEMAS["surefoot.StateEstimate"])["properties"]["p_WF"]
    assert feet["unit"] == "m" and "foot centres" in feet["description"]


def test_a_topic_can_be_written_in_a_path(summary):
    """As in the grammar of message paths: words between slashes, nothing that needs quotes."""
    assert all(re.fullmatch(r"[\w-]+(/[\w-]+)*", channel.topic) for channel in summary.channels.values())


def test_the_index_leads_to_every_message(exported, summary):
    counts = summary.statistics.channel_message_counts
    assert sum(counts.values()) == summary.statistics.message_count == len(list(items_of(exported[1])))
    assert {number for part in summary.chunk_indexes for number in part.message_index_offsets} == counts.keys()
    assert {part.compression for part in summary.chunk_indexes} == {"zstd"}
    assert all(channel.schema_id in summary.schemas for channel in summary.channels.values())


# What PlotJuggler asks for ------------------------------------------------------------------------------


def test_the_end_of_the_file_says_where_its_lists_are(exported):
    """Else PlotJuggler goes through the whole file, or takes it for damaged."""
    with exported[1].open("rb") as file:
        records = list(StreamReader(file, validate_crcs=True).records)
    (footer,) = (each for each in records if isinstance(each, Footer))
    assert 0 < footer.summary_start < footer.summary_offset_start and footer.summary_crc
    told = {each.group_opcode for each in records if isinstance(each, SummaryOffset)}
    assert {Opcode.SCHEMA, Opcode.CHANNEL, Opcode.STATISTICS, Opcode.CHUNK_INDEX, Opcode.METADATA_INDEX} <= told


def test_read_from_front_to_back_it_is_the_same(exported):
    """As PlotJuggler reads; its curves are in the order of their times."""
    times: dict[str, list] = {}
    for _, channel, message in items_of(exported[1], NonSeekingReader):
        times.setdefault(channel.topic, []).append(message.log_time)
    assert all(each == sorted(each) for each in times.values())
    assert sum(map(len, times.values())) == len(list(items_of(exported[1])))


def test_every_message_is_an_object(exported):
    """A list at the root would be taken for several messages, and the root's name be lost."""
    assert all(isinstance(strict(message.data), dict) for _, _, message in items_of(exported[1]))
