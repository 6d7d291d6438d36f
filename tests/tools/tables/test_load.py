"""A recording as tables: every number is the one of the decoded message, and what is missing is told."""

import builtins
import subprocess
import sys

import numpy as np
import pytest
import scenes

import surefoot.tools
from surefoot.bus.codec import decode, encode
from surefoot.bus.errors import RecordingError
from surefoot.bus.message import specs
from surefoot.bus.messages import FsmEvent, MotionReference, StateEstimate
from surefoot.bus.recording.reader import Recording
from surefoot.bus.recording.writer import RecordingWriter
from surefoot.bus.topics import TOPICS
from surefoot.config.typed_toml import ConfigError
from surefoot.tools.tables.table import NotRecorded

CLIP = scenes.path("collapse")


@pytest.fixture(scope="module")
def recording():
    return surefoot.tools.load(CLIP)


@pytest.fixture(scope="module")
def messages():
    """What the file holds, message by message."""
    found = {}
    for item in Recording(CLIP):
        if item.key in TOPICS and not item.digest:
            found.setdefault(item.key, []).append(decode(TOPICS[item.key].message, item.payload))
    return found


@pytest.mark.parametrize("name", scenes.SCENES)
def test_every_field_of_every_message_is_in_its_table(name):
    recording = surefoot.tools.load(scenes.path(name))
    seen = dict.fromkeys(recording, 0)
    for item in Recording(scenes.path(name)):
        if item.key not in TOPICS or item.digest:
            continue
        message, row, table = decode(TOPICS[item.key].message, item.payload), seen[item.key], recording[item.key]
        for field in specs(type(message)):
            np.testing.assert_array_equal(table[field][row], getattr(message, field), strict=False)
        seen[item.key] += 1
    assert seen == recording.counts


def test_shapes_are_those_of_the_messages_behind_the_axis_of_time(recording):
    table = recording["state/estimate"]
    assert table["p_WF"].shape == (471, 4, 3) and table["contact"].dtype == bool
    assert table.spec("p_WF").unit == "m" and "leg kinematics" in table.spec("p_WF").doc
    assert recording["fsm/reference"]["state"][0] == "PROBE"


def test_fields_of_open_length_are_one_array_where_they_can_be(recording):
    policy = recording.read("mpc/policy", fields=("x", "constraint"))
    assert policy["x"].ndim == 3 and policy["x"].shape[2] == 24
    assert set(policy) == {"t", "seq", "boot", "valid", "x", "constraint"}
    forces = surefoot.tools.load(scenes.path("probe_holds"))["fsm/reference"]["probe_force_W"]
    assert {each.shape for each in forces} == {(8, 3), (0, 3)} or forces.dtype != object


def test_arrays_of_different_lengths_stay_arrays_of_their_own(tmp_path):
    writer = RecordingWriter(tmp_path / "a.mcap", {"config": "{}"})
    for seq, count in enumerate((2, 0, 3)):
        forces = np.full((count, 3), float(seq))
        message = MotionReference(t=0.1 * seq, seq=seq, valid=True, probe_force_W=forces)
        writer.add_record(("fsm/reference", seq * 10**8, seq, encode(message)))
    writer.close()
    forces = surefoot.tools.load(tmp_path / "a.mcap")["fsm/reference"]["probe_force_W"]
    assert forces.dtype == object and [each.shape for each in forces] == [(2, 3), (0, 3), (3, 3)]
    assert (forces[2] == 2.0).all()


def test_a_stretch_of_time_can_be_read_alone(recording, messages):
    table = recording.read("hw/state", fields=("q",), begin_s=23.4, end_s=23.5)
    expected = [message.q for message in messages["hw/state"] if 23.4 <= message.t <= 23.5]
    np.testing.assert_array_equal(table["q"], expected)


def test_listeners_get_messages_in_the_order_of_their_times(recording, messages):
    keys = ("hw/state", "fsm/reference", "sim/truth")
    told = list(recording.messages(keys, 23.2, 23.6))
    assert [message.t for _, message in told] == sorted(message.t for _, message in told)
    count = sum(23.2 <= message.t <= 23.6 for key in keys for message in messages.get(key, ()))
    assert len(told) == count > 250


def test_a_row_is_found_by_its_time(recording):
    table = recording["state/estimate"]
    rows = table.at(np.array([0.0, 23.3, 23.3009, 99.0]))
    assert rows[0] == 0 and table.t[rows[1]] == pytest.approx(23.3) and rows[2] == rows[1]
    assert rows[3] == table.rows - 1


def test_what_it_was_made_with_is_there(recording):
    assert recording.config["terrain"]["kind"] == "planks" and recording.deployment.terrain.kind == "planks"
    assert recording.versions["how"].startswith("clip of") and recording.versions["version"]
    assert recording.span_s == (21.202, 23.94)
    assert any("only digests" in words for words in recording.missing)


def test_what_is_not_there_is_answered_by_what_is(recording):
    with pytest.raises(NotRecorded, match=r"no topic 'state/truth' in it; there are hw/state"):
        recording["state/truth"]
    with pytest.raises(NotRecorded, match=r"no field 'p_WX'; a StateEstimate has t, seq"):
        recording.read("state/estimate", fields=("p_WX",))
    with pytest.raises(NotRecorded, match="no field 'u' here; there are t, seq"):
        recording.read("mpc/policy", fields=("x",))["u"]
    assert "sim/truth" not in recording and recording.get("sim/truth") is None


@pytest.mark.parametrize("share", [0.3, 0.6, 0.95])
def test_a_file_that_was_cut_off_is_read_as_far_as_it_goes(tmp_path, share, recording):
    whole = CLIP.read_bytes()
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(whole[: round(share * len(whole))])
    half = surefoot.tools.load(cut)
    assert half.missing[0].startswith("the file is incomplete: it ends in the middle")
    for key in half:
        rows = half[key].rows
        np.testing.assert_array_equal(half[key]["t"], recording[key]["t"][:rows])
    assert 0 < sum(half.counts.values()) < sum(recording.counts.values())


def test_messages_that_were_lost_are_counted(tmp_path):
    writer = RecordingWriter(tmp_path / "a.mcap", {"config": "{}"})
    for seq, boot in ((0, 0), (1, 0), (5, 0), (0, 1), (2, 1)):
        event = FsmEvent(t=0.1 * seq + boot, seq=seq, boot=boot, valid=True, kind="note")
        writer.add_record(("fsm/event", round(event.t * 1e9), seq, encode(event)))
    writer.close()
    recording = surefoot.tools.load(tmp_path / "a.mcap")
    assert recording.missing == [] and recording["fsm/event"].missing == 4
    assert recording.missing == ["fsm/event: 4 messages are missing"]


def test_a_data_frame_has_a_column_for_each_number(recording, messages):
    pytest.importorskip("pandas")
    frame = recording.pandas("state/estimate")
    assert frame.index.name == "t" and len(frame) == 471
    last: StateEstimate = messages["state/estimate"][-1]
    row = frame.iloc[-1]
    assert row["p_WF_RL_z"] == last.p_WF[2, 2] and row["quat_WB_w"] == last.quat_WB[0]
    assert row["q_FR_calf"] == last.q[5] and bool(row["contact_RR"]) == last.contact[3]
    reference = recording.pandas("fsm/reference")
    assert reference["base_to_yaw"].iloc[0] == messages["fsm/reference"][0].base_to[5]
    assert reference["probe_force_W"].iloc[0].shape[1] == 3  # of open length: one column


def test_without_pandas_the_remedy_is_named(recording, monkeypatch):
    there = builtins.__import__
    monkeypatch.delitem(sys.modules, "pandas", raising=False)

    def missing(name, *rest, **more):
        if name == "pandas":
            raise ImportError(name)
        return there(name, *rest, **more)

    monkeypatch.setattr(builtins, "__import__", missing)
    with pytest.raises(ConfigError, match=r"pip install 'surefoot\[data\]'"):
        recording.pandas("fsm/event")


def test_importing_the_tools_costs_nothing():
    """Only what is asked for is imported."""
    words = (
        "import sys, surefoot.tools; print([m for m in ('numpy', 'mcap', 'zenoh', 'mujoco') if m in sys.modules])"
    )
    told = subprocess.run([sys.executable, "-P", "-c", words], capture_output=True, text=True, check=True)
    assert told.stdout.strip() == "[]"


def test_another_file_is_refused(tmp_path):
    with pytest.raises(RecordingError, match="no such file"):
        surefoot.tools.load(tmp_path / "none.mcap")
    with pytest.raises(RecordingError, match="not a recording"):
        surefoot.tools.load(__file__)
