"""What other programs get is what was recorded, number for number."""

import csv
import sys

import numpy as np
import pytest
import scenes

from surefoot.bus.codec import decode
from surefoot.bus.message import specs
from surefoot.bus.messages import FsmEvent, StateEstimate
from surefoot.bus.recording.reader import Recording
from surefoot.bus.topics import TOPICS
from surefoot.tools.cli import main
from surefoot.tools.tables.column_names import column_names

CLIP = scenes.path("collapse")


def decoded(key, name="collapse"):
    return [
        decode(TOPICS[key].message, item.payload)
        for item in Recording(scenes.path(name))
        if item.key == key and not item.digest
    ]


def export(out, *words, recording=CLIP):
    assert main(["export", str(recording), "--out", str(out), *words]) == 0


# Numbers ------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("csv")
    export(folder, "--to", "csv")
    return folder


def rows_of(path):
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def test_a_row_of_csv_is_a_message(folder):
    rows, messages = rows_of(folder / "state_estimate.csv"), decoded("state/estimate")
    assert len(rows) == len(messages) == 471
    for row, message in zip(rows, messages, strict=True):
        assert float(row["t"]) == message.t and int(row["seq"]) == message.seq
        feet = [[float(row[f"p_WF_{leg}_{axis}"]) for axis in "xyz"] for leg in ("FL", "FR", "RL", "RR")]
        np.testing.assert_array_equal(feet, message.p_WF)
        assert row["contact_RR"] == str(bool(message.contact[3]))
        assert float(row["quat_WB_w"]) == message.quat_WB[0]
    events = rows_of(folder / "fsm_event.csv")
    assert [row["reason"] for row in events] == [event.reason for event in decoded("fsm/event")]


def test_every_column_is_explained(folder):
    explained = {(row["topic"], row["column"]): row for row in rows_of(folder / "columns.csv")}
    for path in folder.glob("*_*.csv"):
        topic = path.stem.replace("_", "/", 1)
        with path.open() as file:
            head = next(csv.reader(file))
        assert set(head) == {column for key, column in explained if key == topic}
    force = explained["state/estimate", "force_W_FL_z"]
    assert force["unit"] == "N" and "eq. (7)" in force["meaning"]


def test_columns_have_names_of_their_own():
    for topic in TOPICS.values():
        names = [name for field, spec in specs(topic.message).items() for name in column_names(field, spec)]
        assert len(set(names)) == len(names)
    known = specs(StateEstimate)
    assert column_names("q", known["q"])[:4] == ["q_FL_hip", "q_FL_thigh", "q_FL_calf", "q_FR_hip"]
    assert column_names("covariance", known["covariance"])[10] == "covariance_1_1"
    request = specs(TOPICS["trajopt/request"].message)
    assert column_names("region_a", request["region_a"])[-1] == "region_a_3_3_z"
    assert column_names("base_target", request["base_target"])[5] == "base_target_yaw"


def test_parquet_holds_the_same_and_what_a_row_of_csv_cannot(tmp_path, folder):
    parquet = pytest.importorskip("pyarrow.parquet")
    export(tmp_path, "--to", "parquet")
    table = parquet.read_table(tmp_path / "state_estimate.parquet")
    assert table["p_WF_RL_z"].to_pylist() == [
        float(row["p_WF_RL_z"]) for row in rows_of(folder / "state_estimate.csv")
    ]
    assert table.schema.field("force_W_FL_z").metadata[b"unit"] == b"N"
    forces = parquet.read_table(tmp_path / "fsm_reference.parquet")["probe_force_W"].to_pylist()
    assert forces == [message.probe_force_W.tolist() for message in decoded("fsm/reference")]
    assert not (tmp_path / "mpc_policy.parquet").exists()


def test_half_a_recording_is_exported_as_far_as_it_goes(tmp_path, capsys):
    whole = CLIP.read_bytes()
    (tmp_path / "cut.mcap").write_bytes(whole[: len(whole) // 2])
    export(tmp_path / "csv", "--to", "csv", recording=tmp_path / "cut.mcap")
    assert "missing: the file is incomplete" in capsys.readouterr().out
    assert 0 < sum(len(rows_of(path)) for path in (tmp_path / "csv").glob("*_*.csv")) < 1900


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (["--to", "csv", "--topics", "state/truth", "--out", "{tmp}"], "no topic 'state/truth' in it; there are"),
        (["--to", "csv", "--from", "99", "--out", "{tmp}"], "nothing from 99 to inf s; it is of 21.202 to 23.940"),
        (["--to", "csv", "--out", __file__], "--to csv writes a folder, and that is a file"),
        (["--to", "json-mcap", "--out", "{tmp}/a.json"], "writes a file that ends in .mcap"),
        (["--to", "json-mcap", "--out", str(CLIP)], "that is the recording itself"),
        (["--to", "urdf", "--out", "{tmp}/none/a.urdf"], "there is no folder"),
    ],
)
def test_a_wrong_call_is_answered_by_what_would_be_right(call, words, capsys, tmp_path):
    assert main(["export", str(CLIP), *(word.format(tmp=tmp_path) for word in call)]) == 2
    assert words in capsys.readouterr().err


def test_another_file_and_another_robot_are_refused(capsys, tmp_path):
    assert main(["export", __file__, "--to", "csv", "--out", str(tmp_path)]) == 2
    assert "not a recording" in capsys.readouterr().err
    assert main(["export", "spot", "--to", "urdf", "--out", str(tmp_path / "a.urdf")]) == 2
    assert "robot 'spot' is not described; known: aliengo" in capsys.readouterr().err


def test_without_pyarrow_the_remedy_is_named(capsys, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    assert main(["export", str(CLIP), "--to", "parquet", "--out", str(tmp_path)]) == 2
    assert "pip install 'surefoot[data]'" in capsys.readouterr().err


def test_events_are_written_with_their_words(folder):
    event: FsmEvent = decoded("fsm/event")[2]
    row = rows_of(folder / "fsm_event.csv")[2]
    assert (row["kind"], float(row["displacement_m"])) == ("collapse", event.displacement_m)
