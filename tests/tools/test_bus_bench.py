"""The figures of the bus come from real processes that get every message; how large they are no test decides."""

import pytest

from surefoot.bus.topics import PROCESSES, TOPICS
from surefoot.config.deployment import Deployment
from surefoot.tools import bus_bench
from surefoot.tools.bus_latency import bus_latency
from surefoot.tools.recording.contents import Contents

WALKED_S = 0.25


@pytest.fixture(scope="module")
def walked():
    """A stack in one process, what it told its journals, and its deployment."""
    deployment = Deployment()
    return *bus_bench.walk(deployment, WALKED_S), deployment


def test_every_topic_arrives_from_the_hub_and_through_it(walked):
    messages = bus_bench.messages(walked[1])
    found = bus_latency(bus_bench.namespace("latency"), messages, 0.3)
    topics = found["topics"]
    assert topics.keys() == messages.keys() >= {"hw/state", "state/estimate", "joint/command", "mpc/policy"}
    assert {key for key in topics if topics[key]["direct"]} == {"hw/state", "sim/truth"}
    for key, of in topics.items():
        assert 0 <= of["lost"] < of["sent"], key
        assert 0.0 < of["p50_ms"] <= of["p99_ms"] < 60e3, key
        assert of["bytes"] > 20.0 and of["hz"] == (TOPICS[key].rate_hz or 10.0) and of["decode_us"] > 0.0
    assert found["cpu_us"].keys() == {"client", "hub", "reader"}
    assert all(us > 0.0 for us in found["cpu_us"].values())


def test_the_recorder_that_is_measured_writes_all_that_was_published(walked, tmp_path):
    stack, tapes, deployment = walked
    found = bus_bench.recording(stack, deployment, tapes, tmp_path / "a.mcap")
    contents = Contents(tmp_path / "a.mcap")
    assert found["lost"] == [] and contents.gaps == []
    recorded = {key: topic.messages for key, topic in contents.topics.items()}
    assert recorded == {key: len(payloads) for key, payloads in bus_bench.messages(tapes).items()}
    assert found["journals"].keys() == set(PROCESSES)
    assert found["recorder"] > 0.0 and found["mb_per_s"] > 0.0 and found["handing_over"] > 0.0


def test_seven_processes_are_measured_and_ended(tmp_path):
    found = {"latency": {"topics": {}, "cpu_us": {}}, "recording": {"journals": {}}}
    found["recording"] |= {"recorder": 0.11, "handing_over": 0.0, "mb_per_s": 4.0, "lost": []}
    found["cycle_hz"] = bus_bench.live_cycle_hz(0.02, 0.05, tmp_path)
    assert found["cycle_hz"] > 0.0
    told = {what: (asked, got) for what, asked, got in bus_bench.rows(found, 0.8)}
    assert told["  in one process"] == ("", "   400")
    assert told["recorder [share of a core]"] == ("<= 0.1", " 0.110  missed")
