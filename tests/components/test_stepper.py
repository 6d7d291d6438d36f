"""A process that takes the place of another in simulated time."""

import numpy as np

from surefoot.bus.topics import PROCESSES
from surefoot.components import clock_messages as clock
from surefoot.components.estimator.estimator import Estimator
from surefoot.components.stepper import Stepper
from surefoot.components.wbc.wbc import Wbc
from surefoot.config.deployment import Deployment


class Session:
    """In place of the bus: nobody keeps anything."""

    def ask(self, key):
        return []

    def put(self, key, payload, lossless=True):
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
