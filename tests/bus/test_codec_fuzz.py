"""Whatever bytes arrive: a message that holds what its topic promises, or an error that names field and value."""

import re
import struct
import tracemalloc

import msgpack
import numpy as np
import pytest

from surefoot.bus.codec import check, decode, encode
from surefoot.bus.errors import MessageError
from surefoot.bus.message import specs
from surefoot.bus.messages import DepthFrame, FsmEvent, HardwareState, Policy, StateEstimate
from surefoot.bus.topics import TOPICS

MESSAGES = sorted({topic.message for topic in TOPICS.values()}, key=lambda cls: cls.__name__)
DAMAGED = 300  # by each kind of damage, for each type of message
DEEP = 500
LONGEST_ERROR = 400

ODD = (
    None,
    True,
    False,
    0,
    -1,
    2**63,
    2**64 - 1,
    -(2**63),
    1.5,
    float("nan"),
    float("inf"),
    -float("inf"),
    "",
    "words",
    "\0",
    b"",
    b"\0" * 96,
    b"\xff" * 96,
    b"\2\2\2\2",
    [],
    [[], b""],
    [[0], b""],
    [[-1], b""],
    [[3, 3], b""],
    [[2**31], b""],
    [[2**64 - 1, 0], b""],
    [[0, 2**62], b""],
    [[2**32, 2**32, 0, 2**40], b""],
    [[True, True], b"\0" * 8],
    [[1.0], b"\0" * 8],
    [["1"], b"\0" * 8],
    [[1], "12345678"],
    ["a", 1],
    ["a", b"b"],
    {},
    {"not": "this"},
    msgpack.ExtType(5, b"ext"),
    msgpack.Timestamp(0, 1),
)
"""What a field may be given instead: every type of msgpack, lengths that lie, the ends of every range."""


def nested(kind, levels=DEEP):
    value = 0
    for _ in range(levels):
        value = kind(value)
    return value


DEEPLY = (nested(lambda inner: [inner]), nested(lambda inner: {"a": inner}), [nested(lambda inner: [inner]), b""])


def filled(cls, rng):
    """A message whose every field has some content."""
    values = {}
    for name, spec in specs(cls).items():
        if spec.kind == "array":
            shape = [int(rng.integers(0, 4)) if n == -1 else n for n in spec.shape]
            values[name] = (rng.normal(size=shape) * 100).astype(spec.dtype)
        else:
            values[name] = {
                "number": float(rng.normal()),
                "integer": int(rng.integers(-5, 5)),
                "flag": bool(rng.integers(2)),
                "names": ("a", "wörd"),
                "text": "wörd",
            }[spec.kind]
    return cls(**values)


def examine(cls, data):
    """The rule of every payload; returns the error, if it was refused."""
    try:
        message = decode(cls, data)
    except MessageError as error:
        words = str(error)
        assert re.match(rf"{cls.__name__}(\.\w+(\[[\d, ]+\])? = |: )", words), words
        assert len(words) < LONGEST_ERROR and words.isprintable(), words
        return words
    assert check(message) is message
    for name, spec in specs(cls).items():
        value = getattr(message, name)
        if spec.kind == "array":
            assert value.dtype == spec.dtype and value.ndim == len(spec.shape), name
            assert spec.dtype != "bool" or set(value.view(np.uint8).ravel().tolist()) <= {0, 1}, name
        else:
            kind = {"number": float, "integer": int, "flag": bool, "text": str, "names": tuple}[spec.kind]
            assert type(value) is kind, name
    again = encode(message)
    assert encode(decode(cls, again)) == again
    return ""


@pytest.fixture(params=MESSAGES, ids=lambda cls: cls.__name__)
def cls(request):
    return request.param


@pytest.fixture
def rng(cls):
    return np.random.default_rng([MESSAGES.index(cls), 7])


def test_bits_that_flip(cls, rng):
    for _ in range(DAMAGED):
        data = bytearray(encode(filled(cls, rng)))
        for place in rng.integers(0, 8 * len(data), rng.integers(1, 4)):
            data[place // 8] ^= 1 << (place % 8)
        examine(cls, bytes(data))


def test_bytes_that_are_cut_doubled_inserted_or_replaced(cls, rng):
    for _ in range(DAMAGED):
        data = encode(filled(cls, rng))
        a, b = sorted(rng.integers(0, len(data), 2))
        noise = rng.bytes(int(rng.integers(1, 12)))
        pieces = (
            data[:a],
            data[a:],
            data[:a] + data[b:],
            data[:b] + data[a:],
            data[:a] + noise + data[a:],
            data[:a] + noise + data[b:],
            data + data,
            noise,
        )
        for piece in pieces:
            examine(cls, piece)


def test_markers_of_msgpack_in_any_place(cls, rng):
    """A type's own byte where another was: lengths of gigabytes, other types, the unused code."""
    markers = [bytes([code]) for code in range(0xC0, 0xE0)]
    markers += [code + struct.pack(">I", 2**32 - 1) for code in (b"\xc6", b"\xc9", b"\xdb", b"\xdd", b"\xdf")]
    for _ in range(DAMAGED):
        data = encode(filled(cls, rng))
        place, marker = int(rng.integers(0, len(data))), markers[rng.integers(len(markers))]
        examine(cls, data[:place] + marker + data[place + len(marker) :])


def test_every_field_with_every_odd_value(cls, rng):
    fields = msgpack.unpackb(encode(filled(cls, rng)))
    for name in specs(cls):
        for odd in ODD + DEEPLY:
            words = examine(cls, msgpack.packb({**fields, name: odd}))
            assert not words or re.match(rf"{cls.__name__}\.{name}(\[[\d, ]+\])? = .", words), words


def test_arrays_of_a_wrong_size_or_with_numbers_that_are_none(cls, rng):
    fields = msgpack.unpackb(encode(filled(cls, rng)))
    for name, spec in specs(cls).items():
        if spec.kind != "array":
            continue
        shape = [2 if n == -1 else n for n in spec.shape]
        free = -1 in spec.shape
        for dtype in ("<f8", "<f4", "<i8", "<i2", "?"):
            raw = np.ones(shape, dtype).tobytes()
            same = np.dtype(dtype).itemsize == np.dtype(spec.dtype).itemsize
            words = examine(cls, msgpack.packb({**fields, name: [shape, raw] if free else raw}))
            assert bool(words) != same or spec.dtype == "bool", (name, dtype, words)
        for wrong in ([*shape, 1], shape[:-1], [n + 1 for n in shape], shape[::-1]):
            raw = np.ones(wrong, spec.dtype).tobytes()
            words = examine(cls, msgpack.packb({**fields, name: [wrong, raw] if free else raw}))
            fits = len(raw) == np.ones(shape, spec.dtype).nbytes
            if free:
                fits = [a if a == -1 else b for a, b in zip(spec.shape, wrong, strict=False)] == list(spec.shape)
                fits = fits and len(wrong) == len(spec.shape)
            assert bool(words) != fits, (name, wrong)
        if not spec.dtype.startswith("float"):
            continue
        for bad in (np.nan, np.inf, -np.inf):
            values = np.ones(shape, spec.dtype)
            values.flat[int(rng.integers(values.size))] = bad
            raw = values.tobytes()
            words = examine(cls, msgpack.packb({**fields, name: [shape, raw] if free else raw}))
            place = ", ".join(str(index) for index in np.argwhere(~np.isfinite(values))[0])
            assert words == (f"{cls.__name__}.{name}[{place}] = {bad}: not finite" if spec.finite else "")


def test_fields_that_are_missing_doubled_misnamed_or_unknown(cls, rng):
    message = filled(cls, rng)
    fields = msgpack.unpackb(encode(message))
    for name in fields:
        fewer = {key: value for key, value in fields.items() if key != name}
        assert bool(examine(cls, msgpack.packb(fewer))) == (name == "message")
    pack = msgpack.packb
    pairs = [pack(key) + pack(value) for key, value in fields.items()]

    def of(pairs):
        return struct.pack(">BH", 0xDE, len(pairs)) + b"".join(pairs)

    assert not examine(cls, of(pairs))
    for pair in pairs:
        assert not examine(cls, of([*pairs, pair])), "the same said twice"
    for key in (0, 1.5, None, True, [], {}, [1], msgpack.ExtType(1, b"")):
        assert examine(cls, of([*pairs, pack(key) + pack(0)])), key
    for key in (b"t", b"\xff", "\0"):
        assert not examine(cls, of([*pairs, pack(key) + pack(0)])), key
    assert not examine(cls, pack({**fields, "unknown": nested(lambda inner: [inner])}))
    for wrong in (None, 1, "", "Message", cls.__name__.lower(), cls.__name__ + "\0", [cls.__name__], DEEPLY[0]):
        assert "another type" in examine(cls, pack({**fields, "message": wrong}))
    for whole in ODD + DEEPLY:
        assert examine(cls, pack(whole))


@pytest.mark.parametrize("levels", [1_000, 10_000, 100_000])
@pytest.mark.parametrize("opening", [b"\x91", b"\x81\xa1a"], ids=["lists", "maps"])
def test_nesting_as_deep_as_the_stack_and_deeper(levels, opening):
    deep = opening * levels + b"\xc0"
    data = encode(HardwareState())
    assert examine(HardwareState, deep)
    for name in (b"\xa1q", b"\xa7message", b"\xa1x"):
        words = examine(HardwareState, bytes([data[0] + 1]) + data[1:] + name + deep)
        assert words or (name == b"\xa1x" and levels == 1_000), "an unknown field as deep as msgpack goes"


@pytest.mark.parametrize("kind", [HardwareState, DepthFrame, Policy, StateEstimate, FsmEvent])
def test_no_memory_is_taken_for_what_a_length_only_claims(kind):
    fields = msgpack.unpackb(encode(kind()))
    claims = [
        marker + struct.pack(">I", length)
        for marker in (b"\xc6", b"\xc9", b"\xdb", b"\xdd", b"\xdf")
        for length in (2**20, 2**28, 2**32 - 1)
    ]
    payloads = [*claims, *(encode(kind())[:-1] + claim for claim in claims)]
    for name, spec in specs(kind).items():
        payloads += [b"\x82\xa7message" + msgpack.packb(kind.__name__) + msgpack.packb(name) + c for c in claims]
        if -1 in spec.shape:
            for shape in ([2**20] * len(spec.shape), [0] * (len(spec.shape) - 1) + [2**40], [2**40] + [0]):
                payloads.append(msgpack.packb({**fields, name: [shape, b""]}))
    tracemalloc.start()
    try:
        for payload in payloads:
            tracemalloc.reset_peak()
            before = tracemalloc.get_traced_memory()[0]
            examine(kind, payload)
            taken = tracemalloc.get_traced_memory()[1] - before
            assert taken < 200_000 + 50 * len(payload), f"{taken} bytes for {len(payload)}: {payload[:60]!r}"
    finally:
        tracemalloc.stop()
