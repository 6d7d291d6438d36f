"""A recording as MCAP with messages in JSON, which Foxglove and PlotJuggler read."""

from __future__ import annotations

import json
from pathlib import Path

from mcap.well_known import MessageEncoding, SchemaEncoding
from mcap.writer import CompressionType, Writer

from surefoot.bus.topics import TOPICS
from surefoot.tools.export.contents import Contents
from surefoot.tools.export.foxglove_scene import SCHEMA_NAME, TOPIC, scene_schema, scene_updates
from surefoot.tools.export.json_shape import plain_json_schema, to_json
from surefoot.tools.tables.recording_tables import RecordingTables

_WINDOW_S = 5.0  # of the recording in memory at once
_NS = 1e-9  # between two windows


def write_json_mcap(recording: RecordingTables, wanted: Contents, out: Path) -> int:
    """Write the chosen topics in the order of their times, the scene before them; returns how many messages.

    Raises:
        OSError: it cannot be written.
    """
    count = 0
    with out.open("wb") as file:
        writer = Writer(file, compression=CompressionType.ZSTD)
        writer.start("", "surefoot export")
        writer.add_metadata("surefoot-export", recording.versions | {"config": json.dumps(recording.config)})
        channels = {key: _channel(writer, key) for key in wanted.keys}
        count += _write_scene(writer, recording, wanted) if wanted.scene else 0
        begin_s = wanted.begin_s
        while begin_s <= wanted.end_s:
            end_s = min(begin_s + _WINDOW_S - _NS, wanted.end_s)
            for key, message in recording.messages(wanted.keys, begin_s, end_s):
                t_ns = round(1e9 * message.t)
                writer.add_message(channels[key], t_ns, to_json(message), t_ns, message.seq & 0xFFFFFFFF)
                count += 1
            begin_s += _WINDOW_S
        writer.finish()
    return count


def _write_scene(writer: Writer, recording: RecordingTables, wanted: Contents) -> int:
    schema = writer.register_schema(SCHEMA_NAME, SchemaEncoding.JSONSchema, scene_schema())
    channel = writer.register_channel(TOPIC, MessageEncoding.JSON, schema)
    count = 0
    for t_ns, update in scene_updates(recording, wanted.begin_s, wanted.end_s):
        writer.add_message(channel, t_ns, update, t_ns, count)
        count += 1
    return count


def _channel(writer: Writer, key: str) -> int:
    kind = TOPICS[key].message
    schema = writer.register_schema(
        f"surefoot.{kind.__name__}", SchemaEncoding.JSONSchema, plain_json_schema(kind)
    )
    return writer.register_channel(key, MessageEncoding.JSON, schema)
