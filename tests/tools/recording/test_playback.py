"""A recording that is played back on a bus is heard there as it was."""

import os
import threading
import time

import pytest
import scenes

from surefoot.bus.errors import RecordingError
from surefoot.bus.recording.reader import Recording
from surefoot.bus.session import Session
from surefoot.bus.topics import TOPICS
from surefoot.tools.recording.playback import playback

CLIP = scenes.path("step")
BEGIN, END = 2.6, 2.9
NAMESPACE = f"test-{os.getpid()}-playback"


def test_what_was_recorded_is_heard_in_order_of_time():
    recorded = [
        item
        for item in Recording(CLIP)
        if item.key in TOPICS and not item.digest and BEGIN <= item.t_ns / 1e9 <= END
    ]
    heard, said, sent = [], [], []
    player = threading.Thread(target=lambda: sent.append(playback(CLIP, NAMESPACE, 0.1, BEGIN, END, said.append)))
    player.start()
    while not said:
        time.sleep(0.01)
    session = Session(NAMESPACE, connect_ms=20_000)
    session.subscribe("hw/state", lambda key, payload: heard.append(bytes(payload)))
    player.join()
    session.close()
    assert sent == [len(recorded)] and said[-1] == f"played {len(recorded)} messages"
    states = [item.payload for item in sorted(recorded, key=lambda item: item.t_ns) if item.key == "hw/state"]
    assert len(heard) > 10 and heard == states[-len(heard) :]  # who comes late hears the rest


def test_a_time_of_which_nothing_was_recorded_is_told():
    with pytest.raises(RecordingError, match="nothing recorded between 900 and 901 s"):
        playback(CLIP, NAMESPACE, 1.0, 900.0, 901.0, lambda said: None)
