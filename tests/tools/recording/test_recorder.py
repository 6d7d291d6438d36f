"""The recorder gets what was lost on the way from the process that keeps it, also from a slow one."""

import os
import time

import pytest

from surefoot.bus.codec import encode
from surefoot.bus.messages import OperatorCommand
from surefoot.bus.recording.journal import Batch
from surefoot.bus.recording.reader import Recording
from surefoot.bus.service_keys import LOG
from surefoot.bus.session import Session
from surefoot.components.deployment_desk import serve_deployment
from surefoot.config.deployment import Deployment
from surefoot.tools.recording import recorder
from surefoot.tools.recording.recorder import Recorder

NUMBERS = 4


def batch(number):
    payload = encode(OperatorCommand(t=0.1 * number, seq=number, valid=True, command="stand"))
    record = ("operator/command", number * 10**8, number, payload)
    return Batch("io", 0, number, number == NUMBERS - 1, [record]).pack()


@pytest.fixture
def taken(tmp_path, monkeypatch):
    """Records a process whose batches 1 and 2 are lost, and which gives `answer(number)` to who asks."""
    monkeypatch.setattr(recorder, "_ANSWER_S", 0.2)
    namespace = f"test-{os.getpid()}-recorder"
    hub = Session(namespace, hub=True)
    client = Session(namespace)
    serve_deployment(hub, Deployment())

    def take(answer):
        hub.serve_each(f"{LOG}/io", answer)
        taken = Recorder(client, tmp_path / "a.mcap")
        for number in (0, NUMBERS - 1):
            hub.put(f"{LOG}/io", batch(number))
        taken.run(lambda: False)
        return taken, [item.seq for item in Recording(tmp_path / "a.mcap")]

    yield take
    client.close()
    hub.close()


def test_a_process_that_is_slow_to_answer_is_asked_again(taken, monkeypatch):
    monkeypatch.setattr(recorder, "_GIVE_UP_S", 120.0)
    asked = []

    def answer(number):
        asked.append(number)
        if len(asked) == 1:
            time.sleep(0.6)  # longer than it is waited for
        return batch(number)

    done, recorded = taken(answer)
    assert done.lost == [] and recorded == list(range(NUMBERS))
    assert asked[:2] == [1, 1]
    assert "in 0.3 s of the run's time" in done.summary()


def test_what_is_no_longer_kept_is_told_and_the_rest_is_still_fetched(taken):
    done, recorded = taken(lambda number: batch(number) if number == 2 else None)
    assert recorded == [0, 2, 3]
    assert done.lost == ["io: batches 1 to 1 after 0 restarts"]


def test_a_process_that_does_not_answer_is_given_up(taken, monkeypatch):
    monkeypatch.setattr(recorder, "_GIVE_UP_S", 0.0)
    done, recorded = taken(lambda number: time.sleep(0.6))
    assert recorded == [0, 3]
    assert done.lost == ["io: batches 1 to 2 after 0 restarts"]
