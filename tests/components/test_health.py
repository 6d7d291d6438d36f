"""The status of a process names what is the matter, the gravest first."""

from surefoot.bus.codec import decode
from surefoot.bus.messages import ProcessStatus
from surefoot.bus.recording.journal import Journal
from surefoot.bus.topics import PROCESSES
from surefoot.components.component import Component, Inbox
from surefoot.components.health import Health
from surefoot.components.topic_buffer import TopicBuffers
from surefoot.config.deployment import Deployment


class Bus:
    damaged = 0

    def put(self, key, payload, lossless=True):
        self.last = decode(ProcessStatus, payload)


class Worker(Component):
    name = "mpc"


def test_the_trouble_of_the_last_step_is_told_until_a_step_goes_well():
    worker, bus, buffers = Worker(Deployment()), Bus(), TopicBuffers(())
    health = Health(worker, bus, buffers, PROCESSES["mpc"], Journal("mpc"))

    def told(t=0.0):
        health.tell(t, Inbox(()), now=True)
        return bus.last.reason

    assert told() == ""
    worker.trouble = "riccati: node 3"
    assert told() == "riccati: node 3" and told() == "riccati: node 3"
    health.reason, health.lost = "time waits for wbc", "state/estimate: message 3 of 4 did not arrive"
    buffers.drop("fsm/reference: not msgpack")
    words = ("time waits for wbc", "riccati: node 3", "state/estimate: message 3 of 4 did not arrive")
    assert told() == "; ".join((*words, "dropped fsm/reference: not msgpack"))
    health.reason = health.lost = worker.trouble = ""
    assert told(11.0) == ""


def test_what_went_wrong_once_is_told_for_ten_seconds_and_counted_for_ever():
    bus, buffers = Bus(), TopicBuffers(())
    health = Health(Worker(Deployment()), bus, buffers, PROCESSES["mpc"], Journal("mpc"))

    def told(t):
        health.tell(t, Inbox(()), now=True)
        return bus.last.reason

    buffers.drop("fsm/reference: not msgpack")
    assert told(100.0) == told(109.9) == "dropped fsm/reference: not msgpack"
    bus.damaged = 2
    damaged = "2 messages came damaged over a link that broke, and were dropped"
    assert told(110.0) == f"{damaged}; dropped fsm/reference: not msgpack"
    assert told(115.0) == damaged and told(121.0) == "" and bus.last.bad_messages == 1


def test_a_refused_request_is_told_and_is_no_bad_message():
    bus, buffers = Bus(), TopicBuffers(())
    health = Health(Worker(Deployment()), bus, buffers, PROCESSES["mpc"], Journal("mpc"))
    buffers.incidents.note("operator/request", "refused operator/request: stand: no heartbeat yet")
    health.tell(0.0, Inbox(()), now=True)
    assert bus.last.reason == "refused operator/request: stand: no heartbeat yet" and bus.last.bad_messages == 0
