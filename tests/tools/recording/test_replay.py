"""A replay gives each step what it has read, and says what differs and what it had to leave out."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import scenes

from surefoot.bus.codec import decode, encode
from surefoot.bus.messages import FsmEvent, StateEstimate
from surefoot.bus.recording.reader import Recording
from surefoot.bus.recording.writer import DIGEST, RecordingWriter
from surefoot.tools.cli import main
from surefoot.tools.recording.contents import Contents
from surefoot.tools.recording.difference import first_difference
from surefoot.tools.recording.replay import replay

CLIP = scenes.path("step")


def rewritten(tmp_path, change, about=lambda about: about):
    """The clip with every message passed through `change(item)`; None leaves it out."""
    recording = Recording(CLIP)
    path = tmp_path / "changed.mcap"
    writer = RecordingWriter(path, about(dict(recording.about)))
    for item in recording:
        payload = change(item)
        if payload is not None:
            record = (item.key, item.t_ns, item.seq, payload)
            writer.add_record(record, DIGEST) if item.digest else writer.add_record(record)
    writer.close()
    return path


def test_a_changed_message_is_found_with_its_field(tmp_path):
    def change(item):
        if item.key == "state/estimate" and item.seq == 1100:
            message = decode(StateEstimate, item.payload)
            v = message.v_WB_W.copy()
            v[1] += 1.0
            return encode(replace(message, v_WB_W=v))
        return item.payload

    topic = replay(rewritten(tmp_path, change), ["estimator"]).comparison.topics["state/estimate"]
    assert (topic.differing, topic.missing, topic.extra) == (1, 0, 0)
    assert topic.first.startswith("message 1100 at") and "v_WB_W[1]: recorded" in topic.first


def test_a_message_that_is_not_in_the_recording_leaves_out_its_readers_steps(tmp_path):
    path = rewritten(tmp_path, lambda item: None if (item.key, item.seq) == ("hw/state", 1100) else item.payload)
    result = replay(path, ["estimator"])
    assert result.steps["estimator"] == 1100 - 1001
    assert result.left_out["estimator"] > 300  # there is no later state in so short a clip
    assert "hw/state: message 1100" in result.notes[0]
    contents = Contents(path)
    assert "hw/state: 1 of" in contents.gaps[0]
    assert main(["replay", str(path), "--run", "estimator", "--check"]) == 1
    assert main(["info", str(path)]) == 1


def test_a_longer_recording_goes_on_at_the_next_state(tmp_path):
    whole = scenes.record((), tmp_path, until_s=2.2)
    lost = tmp_path / "lost.mcap"
    recording = Recording(whole)
    writer = RecordingWriter(lost, recording.about)
    for item in recording:
        if (item.key, item.seq) != ("hw/state", 300):
            writer.add_record((item.key, item.t_ns, item.seq, item.payload))
    writer.close()
    result = replay(lost, ["estimator"])
    assert result.comparison.topics["state/estimate"].differing == 0
    assert result.left_out["estimator"] == 501 - 300  # up to the state after the step at 1 s
    assert result.steps["estimator"] > 800
    later = replay(whole, ["estimator"], from_t=1.5, until_t=2.1)
    assert later.comparison.equal and 500 < later.steps["estimator"] < 560


def test_what_was_recorded_and_is_not_published_now_is_missing(tmp_path):
    extra = encode(FsmEvent(t=2.5, seq=13, valid=True, kind="note"))
    recording = Recording(CLIP)
    writer = RecordingWriter(tmp_path / "more.mcap", recording.about)
    for item in recording:
        record = (item.key, item.t_ns, item.seq, item.payload)
        writer.add_record(record, DIGEST) if item.digest else writer.add_record(record)
    writer.add_record(("fsm/event", 2_500_000_000, 13, extra))
    writer.close()
    topic = replay(tmp_path / "more.mcap", ["fsm"]).comparison.topics["fsm/event"]
    assert topic.differing + topic.missing == 1


def test_a_configuration_of_another_version_is_read_as_far_as_it_is_known(tmp_path):
    def about(texts):
        config = json.loads(texts["config"])
        config["wbc"]["stiffness_of_old"] = 3.0
        config["an_old_section"] = {"a": 1}
        return texts | {"config": json.dumps(config)}

    result = replay(rewritten(tmp_path, lambda item: item.payload, about), ["fsm"])
    assert result.comparison.equal
    assert any("wbc.stiffness_of_old: unknown" in note for note in result.notes)
    assert any("an_old_section: unknown" in note for note in result.notes)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (["replay", "nowhere.mcap"], "no such file"),
        (["replay", str(CLIP), "--run", "engine"], "no process 'engine'"),
        (["replay", str(CLIP), "--run", "io"], "holds nothing of io"),
        (["replay", str(Path(__file__)), "--run", "wbc"], "not a recording"),
        (["replay", str(CLIP), "--set", "wbc.kp=-1"], "out of range"),
        (["replay", str(CLIP), "--publish", "--speed", "0"], "--speed 0: allowed"),
        (["record", "/nowhere/out.mcap"], "make it first"),
        (["info", "nowhere.mcap"], "no such file"),
    ],
)
def test_a_wrong_call_is_answered_by_what_would_be_right(call, words, capsys):
    assert main(call) == 2
    assert words in capsys.readouterr().err


def test_the_command_shows_counts_and_the_first_difference(capsys):
    assert main(["replay", str(CLIP), "--run", "fsm", "--check"]) == 0
    assert "equal" in capsys.readouterr().out
    call = ["replay", str(CLIP), "--run", "fsm", "--check", "--diff", "--set", "fsm.dwell_s=0.12"]
    assert main(call) == 1
    assert "fsm/reference: message" in capsys.readouterr().out


def test_differences_of_arrays_and_numbers():
    old = StateEstimate(t=1.0, q=np.arange(12.0))
    assert first_difference(old, old) == ""
    assert first_difference(old, replace(old, t=1.5)) == "t: recorded 1.0, now 1.5"
    zeros = StateEstimate(q=np.zeros(12))
    assert "q[0]: recorded 0.0, now -0.0" in first_difference(zeros, replace(zeros, q=-np.zeros(12)))
    assert first_difference(zeros, replace(zeros, q=-np.zeros(12)), tolerance=1e-6) == ""
    near = replace(old, q=old.q + 1e-7)
    assert first_difference(old, near) != "" and first_difference(old, near, tolerance=1e-6) == ""
