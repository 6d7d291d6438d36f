"""A process that takes the place of another: with simulated time, and on the monotonic clock."""

import numpy as np
import pytest

from surefoot.bus.codec import decode, encode
from surefoot.bus.messages import FsmEvent, OperatorCommand, StateEstimate, Tuning
from surefoot.bus.topics import PROCESSES, TOPICS
from surefoot.components import clock_messages as clock
from surefoot.components.elevation_map.elevation_map import ElevationMap
from surefoot.components.estimator.estimator import Estimator
from surefoot.components.fsm.fsm import Fsm
from surefoot.components.stepper import Stepper
from surefoot.components.wbc.wbc import Wbc
from surefoot.config.deployment import Deployment, Run


class Session:
    """In place of the bus: nobody keeps anything."""

    damaged = 0

    def ask(self, key):
        return []

    def put(self, key, payload, lossless=True):
        pass

    def serve_each(self, key, answer):
        pass


def process(kind=Wbc):
    return Stepper(kind(Deployment()), Session(), PROCESSES[kind.name])


def test_a_process_that_has_not_begun_has_nothing_to_hand_over():
    first = process(Estimator)
    first.step(0.0)  # waits for its inputs
    assert first.snapshot() == b""
    second = process(Estimator)
    second.resume(clock.Resume({}, first.snapshot()), {})
    second.step(0.002)
    assert second.health.life.name == "ACTIVATING"


def test_without_what_its_predecessor_had_read_it_does_not_go_on():
    waiting, looks = process(), []

    def look():
        looks.append(waiting.health.lost)
        if len(looks) == 2:
            raise SystemExit(0)  # as when it is told to end

    waiting.look = look
    with pytest.raises(SystemExit):
        waiting.resume(clock.Resume({"fsm/reference": 7}, b""), {"fsm/reference": 8})
    assert looks[0] == looks[1] == "fsm/reference: a message is missing, and io does not answer: is the link down?"


def test_a_memory_of_other_code_is_not_taken_over_and_that_is_told():
    first, second = process(), process()
    first.component._last_force = np.ones((4, 3))
    state = first.component.snapshot()
    second.resume(clock.Resume({}, clock.pack_snapshot(state)), {})
    np.testing.assert_array_equal(second.component._last_force, np.ones((4, 3)))
    third = process()
    third.resume(clock.Resume({}, clock.pack_snapshot(state | {"new": 1})), {})
    assert not third.component._last_force.any() and third.snapshot() == b""
    assert third.health.note.startswith("began anew: a memory of Wbc holds _failures, ")


class LiveSession(Session):
    """In place of the bus on the monotonic clock."""

    def __init__(self):
        self.sent, self.receive = [], {}

    def put(self, key, payload, lossless=True):
        if key in TOPICS and not key.startswith("status/"):
            self.sent.append(decode(TOPICS[key].message, payload))

    def subscribe(self, key, receive):
        self.receive[key] = receive

    def newest(self, key):
        return lambda: None


def live(boot=0):
    stepper = Stepper(Fsm(Deployment()), LiveSession(), PROCESSES["fsm"], boot, simulated=False)
    stepper.connect()
    return stepper, stepper._session


def say(session, seq, command):
    message = OperatorCommand(t=0.1, seq=seq, valid=True, command=command)
    session.receive["operator/command"]("operator/command", encode(message))


def step(stepper, t):
    stepper.read_all()
    stepper.step(t)
    stepper.publish()


def handed_over(age_s):
    """Two state machines, of which the second takes the place of the first; what each has said."""
    (first, old), (second, new) = live(boot=3), live(boot=4)
    say(old, 0, "moonwalk")
    say(new, 0, "moonwalk")
    step(first, 0.1)
    say(new, 1, "forward")  # comes after the last step of the first
    second.rehearse(first.place())
    assert pack(second) == pack(live()[0])
    silent_s = second.take_over(first.place(), 0.1 + age_s)
    step(second, 0.1 + age_s)
    return old.sent, new.sent, second, silent_s


def pack(stepper):
    return clock.pack_snapshot(stepper.component.snapshot())


def test_on_the_monotonic_clock_nobody_can_tell_the_two_apart():
    old, new, second, silent_s = handed_over(0.02)
    assert silent_s == 0.0 and second.health.note == ""
    said = [(type(m).__name__, m.boot, m.seq) for m in old + new]
    kinds = ("OperatorAnswer", "MotionReference", "FsmEvent")
    assert said == [(kind, 3, seq) for seq in (0, 1) for kind in kinds]
    assert "moonwalk" in old[2].reason and new[2].reason.startswith("forward: kept until")  # each command once


def test_with_a_memory_that_is_too_old_it_begins_anew_when_all_have_noticed():
    _, new, second, silent_s = handed_over(0.2)
    assert silent_s == TOPICS["fsm/reference"].stale_after_s == 0.1
    assert second.health.note == "began anew: its memory was 0.200 s old, limit 0.1 s"
    assert [(m.boot, m.seq) for m in new] == [(4, 0), (4, 0), (4, 0)]


def test_the_last_messages_are_handed_over_too():
    first, _ = live()
    first._inbox.deliver("state/estimate", StateEstimate(t=0.09, seq=45, valid=True))
    first.step(0.1)
    second, _ = live()
    second.take_over(first.place(), 0.1)
    assert second._inbox.latest("state/estimate").seq == 45 and second._inbox.new("state/estimate") == []


def test_a_map_is_as_before_after_a_rehearsal():
    deployment = Deployment(run=Run(vision=True, clock="monotonic"))

    def mapper():
        return Stepper(ElevationMap(deployment), LiveSession(), PROCESSES["elevation_map"], simulated=False)

    first, second = mapper(), mapper()
    first.component.map.note(FsmEvent(kind="force_held", p_WF=np.zeros(3), held_n=80.0))
    first.component._last = StateEstimate(t=0.09, seq=45, valid=True)
    first.step(0.1)
    blank = pack(second)
    second.rehearse(first.place())
    assert pack(second) == blank != pack(first)
    assert second.take_over(first.place(), 100.0) == 0.0  # a map does not age
    assert pack(second) == pack(first)


def test_one_that_begins_anew_hears_what_was_changed_before_it_listened():
    changed = [Tuning(valid=True, seq=seq, assignment=(f"fsm.swing_s=0.{6 + seq}",)) for seq in (0, 1)]
    stepper, session = live()
    session.ask = lambda key: [encode(each) for each in changed] if key == "kept/operator/tuning" else []
    stepper.hear_again("operator/tuning")
    step(stepper, 0.1)
    assert stepper.component.deployment.fsm.swing_s == 0.7 and not stepper.buffers.bad
    stepper.hear_again("hw/depth")  # no input of its own
