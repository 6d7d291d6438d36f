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

    def told():
        health.tell(0.0, Inbox(()), now=True)
        return bus.last.reason

    assert told() == ""
    worker.trouble = "riccati: node 3"
    assert told() == "riccati: node 3" and told() == "riccati: node 3"
    health.reason, health.lost = "time waits for wbc", "state/estimate: message 3 of 4 did not arrive"
    buffers.bad, buffers.last_error = 1, "fsm/reference: not msgpack"
    words = ("time waits for wbc", "riccati: node 3", "state/estimate: message 3 of 4 did not arrive")
    assert told() == "; ".join((*words, "dropped fsm/reference: not msgpack"))
    health.reason = health.lost = worker.trouble = ""
    buffers.bad, bus.damaged = 0, 2
    assert told().startswith("2 messages came damaged")
    bus.damaged = 0
    assert told() == ""
