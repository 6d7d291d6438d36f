"""A journal hands over every record once, in order, and steps with exactly what they read."""

import numpy as np
import pytest

from surefoot.bus.codec import decode, encode
from surefoot.bus.errors import MessageError
from surefoot.bus.messages import OperatorCommand
from surefoot.bus.recording import journal as journal_module
from surefoot.bus.recording.journal import Batch, Journal
from surefoot.bus.recording.step_log import Checkpoint, StepLog
from surefoot.tools.recording.recorder import _BEGINNING


def command(seq, boot=0):
    return OperatorCommand(t=0.1 * seq, seq=seq, boot=boot, valid=True, command="stand")


def test_batches_are_numbered_and_hold_every_record_once():
    journal = Journal("fsm", ("operator/command",))
    taken = []
    for seq in range(5):
        journal.note_step(0.1 * seq, [[command(seq)]])
        journal.note_message(0.1 * seq, "fsm/event", seq, b"%d" % seq)
        if seq % 2:
            taken.append(Batch.unpack(journal.take_packed()))
    taken.append(Batch.unpack(journal.take_packed(last=True)))
    assert [batch.number for batch in taken] == [0, 1, 2]
    assert [batch.last for batch in taken] == [False, False, True]
    records = [record for batch in taken for record in batch.records]
    assert [record[3] for record in records if record[0] == "fsm/event"] == [b"0", b"1", b"2", b"3", b"4"]
    logs = [decode(StepLog, record[3]) for record in records if record[0] == "steps/fsm"]
    assert np.concatenate([log.release_t for log in logs]).tolist() == [0.1 * seq for seq in range(5)]
    assert np.concatenate([log.first_step + log.read_step for log in logs]).tolist() == [0, 1, 2, 3, 4]
    assert np.concatenate([log.read_seq for log in logs]).tolist() == [0, 1, 2, 3, 4]
    assert [Batch.unpack(journal.kept(number)) for number in range(3)] == taken
    assert journal.kept(3) is None


def test_who_seldom_tells_anything_keeps_its_beginning_for_a_recorder_that_comes_late(monkeypatch):
    monkeypatch.setattr(journal_module, "_KEPT_S", 0.0)
    journal = Journal("elevation_map")
    for seq in range(80):
        journal.note_message(10.0 * seq, "map/health", seq, b"")
        journal.take_packed()
        if seq <= _BEGINNING:
            assert all(journal.kept(number) is not None for number in range(seq + 1))
    assert journal.kept(0) is None and journal.kept(79) is not None


def test_nothing_noted_is_no_batch():
    journal = Journal("fsm")
    assert journal.take() is None
    assert journal.take(last=True).records == []


def test_a_step_that_reads_several_messages_names_each_with_its_writers_restarts():
    journal = Journal("fsm", ("trajopt/plan", "operator/command"))
    journal.note_step(1.0, [[], [command(7, boot=1), command(8, boot=2)]])
    log = decode(StepLog, journal.take().records[0][3])
    assert log.inputs == ("trajopt/plan", "operator/command")
    assert (log.read_input.tolist(), log.read_boot.tolist(), log.read_seq.tolist()) == ([1, 1], [1, 2], [7, 8])


def test_a_checkpoint_holds_the_state_the_latest_inputs_and_the_next_numbers():
    journal = Journal("fsm", ("operator/command",), boot=3)
    journal.note_step(0.5, [[command(0)]])
    latest = {"operator/command": command(0), "trajopt/plan": None}
    journal.note_checkpoint(0.5, b"state", latest, {"fsm/event": 4}, 2, active=True)
    checkpoint = decode(Checkpoint, journal.take().records[-1][3])
    assert (checkpoint.step, checkpoint.boot, checkpoint.active, checkpoint.fresh) == (1, 3, True, False)
    assert checkpoint.writes_boot == 2
    assert checkpoint.state.tobytes() == b"state"
    assert checkpoint.latest_payloads() == {"operator/command": encode(command(0))}
    assert (checkpoint.outputs, checkpoint.next_seq.tolist()) == (("fsm/event",), [4])


def test_states_are_noted_at_full_seconds_by_every_process():
    journal = Journal("fsm")
    noted = []
    for t in np.arange(0.0, 3.0, 0.03):
        if journal.checkpoint_is_due(t):
            journal.note_checkpoint(t, b"", {}, {}, 0, active=True)
            noted.append(round(float(t), 2))
    assert noted == [0.0, 1.02, 2.01]


@pytest.mark.parametrize("payload", [b"", b"\xc1", b"\x95\x01\x02\x03\x04\x05", b"\x90"])
def test_what_is_no_batch_is_refused(payload):
    with pytest.raises(MessageError, match="not a batch"):
        Batch.unpack(payload)
