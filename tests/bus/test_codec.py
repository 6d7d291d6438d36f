"""The codec loses nothing and lets nothing malformed through."""

import dataclasses

import msgpack
import numpy as np
import pytest

from surefoot.bus.codec import check, decode, encode
from surefoot.bus.errors import MessageError
from surefoot.bus.message import specs
from surefoot.bus.messages import HardwareState, MotionReference, Policy, StateEstimate
from surefoot.bus.topics import PROCESSES, TOPICS

MESSAGES = sorted({topic.message for topic in TOPICS.values()}, key=lambda cls: cls.__name__)


def filled(cls, rng):
    values = {}
    for name, spec in specs(cls).items():
        if spec.kind == "array":
            shape = [3 if n == -1 else n for n in spec.shape]
            values[name] = (rng.normal(size=shape) * 100).astype(spec.dtype)
        elif spec.kind == "number":
            values[name] = float(rng.normal())
        elif spec.kind == "integer":
            values[name] = int(rng.integers(-5, 5))
        elif spec.kind == "flag":
            values[name] = True
        elif spec.kind == "names":
            values[name] = ("a", "b")
        else:
            values[name] = "wörd"
    return cls(**values)


@pytest.mark.parametrize("cls", MESSAGES, ids=lambda cls: cls.__name__)
def test_round_trip_is_exact(cls):
    message = filled(cls, np.random.default_rng(1))
    data = encode(message)
    again = decode(cls, data)
    assert encode(again) == data
    for name, spec in specs(cls).items():
        if spec.kind == "array":
            np.testing.assert_array_equal(getattr(again, name), getattr(message, name))
        else:
            assert getattr(again, name) == getattr(message, name)


@pytest.mark.parametrize("cls", MESSAGES, ids=lambda cls: cls.__name__)
def test_every_damaged_field_is_refused_by_name(cls):
    fields = msgpack.unpackb(encode(filled(cls, np.random.default_rng(2))))
    for name in fields:
        damaged = {**fields, name: {"not": "this"}}
        with pytest.raises(MessageError, match=name):
            decode(cls, msgpack.packb(damaged))


@pytest.mark.parametrize("cls", MESSAGES, ids=lambda cls: cls.__name__)
def test_truncated_bytes_are_refused(cls):
    data = encode(filled(cls, np.random.default_rng(3)))
    for length in range(0, len(data) - 1, max(1, len(data) // 40)):
        with pytest.raises(MessageError):
            decode(cls, data[:length])


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_numbers_that_are_not_finite_are_refused_by_name(bad):
    q = np.zeros(12)
    q[7] = bad
    message = HardwareState(q=q)
    with pytest.raises(MessageError, match=r"HardwareState\.q"):
        check(message)
    with pytest.raises(MessageError, match=r"HardwareState\.q"):
        decode(HardwareState, encode(message))
    with pytest.raises(MessageError, match=r"MotionReference\.swing_t0"):
        decode(MotionReference, encode(MotionReference(swing_t0=bad)))


def test_wrong_shape_is_refused_by_name():
    with pytest.raises(MessageError, match=r"StateEstimate\.p_WF.*expected \(4, 3\)"):
        encode(StateEstimate(p_WF=np.zeros((3, 4))))


def test_equal_runs_give_equal_bytes_without_the_measurements_of_the_machine():
    slow = Policy(stage=("qp",), stage_ms=np.array([9.0]))
    fast = dataclasses.replace(slow, stage_ms=np.array([1.0]))
    assert encode(slow) != encode(fast)
    assert encode(slow, volatile=False) == encode(fast, volatile=False)


def test_unknown_fields_of_a_later_version_are_ignored():
    fields = msgpack.unpackb(encode(HardwareState(t=2.0)))
    assert decode(HardwareState, msgpack.packb({**fields, "new_field": 1})).t == 2.0


def test_the_table_names_only_known_writers_and_triggers():
    for topic in TOPICS.values():
        assert topic.writer in PROCESSES or topic.writer == "operator"
    for process in PROCESSES.values():
        assert bool(process.rate_hz) != bool(process.trigger), process.name
        assert not process.trigger or process.trigger in TOPICS


def test_a_message_of_another_type_is_refused():
    for cls in MESSAGES:
        data = encode(filled(cls, np.random.default_rng(4)))
        for other in MESSAGES:
            if other is not cls:
                with pytest.raises(MessageError, match=f"says '{cls.__name__}': another type"):
                    decode(other, data)
