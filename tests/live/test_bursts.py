"""A second publisher on every key of the bus, plausible or mad: reported by key and reason, without any effect."""

import re
import time
from dataclasses import replace

import msgpack
import numpy as np
from live_bytes import KEYS, assert_same_bytes

from surefoot.bus.codec import decode, encode
from surefoot.bus.message import specs
from surefoot.bus.messages import FsmEvent, JointCommand, OperatorCommand, SimTruth, StateEstimate
from surefoot.bus.topics import PROCESSES, TOPICS
from surefoot.components import clock_messages as clock
from surefoot.components.registry import component_class

READERS = {
    key: [name for name in PROCESSES if name != "io" and key in component_class(name).inputs] for key in KEYS
} | {"joint/command": ["io"]}
NS = 1_000_000_000
MAD = (b"", b"\xc1", b"\x00" * 64, b"\xff" * 300, msgpack.packb({"message": "Nothing"}), b"\xdf\xff\xff\xff\xff")


def other(message):
    """The same message with every number off."""
    changed = {}
    for name, spec in specs(type(message)).items():
        value = getattr(message, name)
        if spec.kind == "array":
            changed[name] = np.logical_not(value) if spec.dtype == "bool" else value * 3 + 1
        elif spec.kind == "text":
            changed[name] = value + "[/bold] another"
    return replace(message, valid=True, **changed)


def burst(key, live):
    """Malformed, of a wrong type or shape, not finite, replayed, out of order, and well formed by another."""
    with live.lock:
        said = list(live.heard.get(key, ()))
    kind = TOPICS[key].message
    last = live.last(key) if said else kind(t=live.t(), valid=True)
    fields = msgpack.unpackb(encode(last))
    wrong = kind if kind is not JointCommand else StateEstimate
    yield from MAD
    yield encode((JointCommand if wrong is kind else wrong)(t=last.t, valid=True))
    for name, spec in specs(kind).items():
        yield msgpack.packb({**fields, name: [1, {"a": None}]})
        if spec.kind == "number":
            yield msgpack.packb({**fields, name: float("nan")})
        elif spec.kind == "array":
            yield msgpack.packb({**fields, name: np.full(7, np.nan).tobytes()})
    yield from said[:3] + said[-3:][::-1]
    for ahead in (-400, -3, -1, 0, 1, 2, 3, 10, 50, 10**9):
        for t in (last.t, last.t + 1e6, -1e6):
            yield encode(replace(other(last), seq=max(last.seq + ahead, 0), t=t))


def reports(live, reader, words):
    return re.search(rf"dropped {words}", live.reason(reader)) is not None and live.status[reader].bad_messages > 0


def reported(live, reader, words):
    live.wait(lambda: reports(live, reader, words))


def test_a_burst_on_every_topic_leaves_every_byte_as_it_was(stack):
    live = stack(("run.vision=true",), leave_out=("trajopt",))
    live.begin(b"forward")
    live.wait(lambda: live.t() >= 0.3)
    for key in KEYS:
        for payload in burst(key, live):
            live.session.put(key, payload)
    waited_for = {(reader, key) for key, readers in READERS.items() for reader in readers}

    def all_reported():
        waited_for.difference_update([each for each in waited_for if reports(live, each[0], f"{each[1]}: .*")])
        return not waited_for

    live.wait(all_reported)
    for name in PROCESSES:
        for payload in burst(f"status/{name}", live):
            live.session.put(f"status/{name}", payload)
    for payload in (*MAD[1:4], b"forward " * 1000, b"\xff\xfe", b"sit\0", *[b"a\nb"] * 500):
        live.session.put(clock.REQUEST, payload)
        live.session.put("supervisor/request", payload)
    reported(live, "io", f"{clock.REQUEST}: .* is no command")
    live.go_on(0.1)
    assert_same_bytes(live)


def test_in_real_time_no_second_publisher_moves_the_robot(stack):
    """It lies, damped: whatever another says for the whole-body controller, no motor gets a torque."""
    live = stack(("run.clock=monotonic", f"run.epoch_s={time.monotonic()!r}"))
    live.wait(lambda: len(live.status) == len(PROCESSES) and live.t() > 4.0 and live.heard["joint/command"])
    begun = len(live.heard["sim/truth"])
    for key in KEYS:
        for payload in burst(key, live):
            live.session.put(key, payload)
    push = replace(live.last("joint/command"), tau=np.full(12, 30.0), kp=np.full(12, 100.0))
    for seq in range(push.seq, push.seq + 200):
        live.session.put("joint/command", encode(replace(push, seq=seq, t=live.t())))
    reported(live, "io", "joint/command: .*")
    for payload in (*MAD[1:], b"\xff\xfe"):
        live.session.put(clock.REQUEST, payload)
    reported(live, "io", f"{clock.REQUEST}: .* is no command")
    live.go_on(0.5)
    assert all(child.poll() is None for child in live.children.values())
    with live.lock:
        truths = [decode(SimTruth, payload) for payload in live.heard["sim/truth"][begun:]]
    # It may still be settling against its damping; the push asks for twice as much.
    assert max(np.abs(truth.tau).max() for truth in truths) < 15.0
    assert live.last("fsm/reference").state == "DAMP"


def test_no_second_publisher_ends_a_run_or_its_screen(supervised):
    live = supervised("run.command=stand")
    live.wait(lambda: len(live.status) == len(PROCESSES) and live.t() > 0.3)
    mad = replace(
        live.last("fsm/reference"), finished=True, leg=9, state="DAMP", reason="[/bold] fallen", t=1e9, seq=10**9
    )
    for _ in range(20):
        live.session.put("fsm/reference", encode(mad))
        live.session.put("state/estimate", encode(StateEstimate(valid=True, seq=10**9)))
        live.session.put("supervisor/request", b"\xff\xc1 nothing")
        live.session.put("fsm/event", encode(FsmEvent(valid=True, seq=10**9, kind="[/bold]", leg=99)))
        live.session.put("operator/command", encode(OperatorCommand(valid=True, seq=10**9, command="[/bold]")))
        live.go_on(0.02)
    assert live.run.poll() is None, live.said()
    assert live.stands() and "fallen" not in live.said()


def forged_releases(true):
    last = clock.unpack_release(true[-1]) if true else clock.Release(300_000_000, {})
    more = {key: count + 5 for key, count in last.visible.items()}
    own = {name: [b"12345678"] for name in PROCESSES}
    yield from true[:2] + true[-2:]
    for ahead in (-NS, 0, 2_000_000, NS):
        for resume in (None, clock.Resume(last.visible, b"\xc1")):
            yield clock.pack_release(clock.Release(last.t_ns + ahead, more, resume, own))
    for whole in (0, [], [1, 2], [1, 2, 3, 4], ["a", {}, None, None], [0, {1: 2}, None, None]):
        yield msgpack.packb(whole)
    for resume in (1, [], [1, 2], [{}, ""], [{"a": -1}, b""]):
        yield msgpack.packb([last.t_ns, {}, resume, None])
    for writers in (1, [], {"io": 1}, {"io": ["a"]}, {1: []}):
        yield msgpack.packb([last.t_ns, {}, None, writers])
    for count in (-1, 1.5, True, None, "1"):
        yield msgpack.packb([last.t_ns, {"joint/command": count}, None, None])
    yield from MAD
    yield clock.pack_release(clock.Release(clock.STOP_NS, {}))


def forged_tokens(true, t_ns):
    yield from true[:2] + true[-2:]
    for ahead in range(10):
        for sent in ({}, {"joint/command": [b""], "fsm/reference": [b"\xc1"] * 2}, {"nothing": [b""]}):
            yield clock.pack_done(clock.Done(t_ns + ahead * 2_000_000, sent, b"\xc1"))
    for whole in (0, [], [1, 2], [1, 2, 3], ["a", {}, b""], [0, {"a": -1}, b""], [0, {"a": [1]}, b""], [0, {}, 1]):
        yield msgpack.packb(whole)
    yield from MAD


def test_a_burst_on_the_clock_s_own_keys_leaves_every_byte_as_it_was(stack):
    live = stack(leave_out=("trajopt",))
    releases = {name: [] for name in PROCESSES if name != "io"}
    tokens = {name: [] for name in releases}
    for name in releases:
        live.session.subscribe(
            f"{clock.RELEASE}/{name}", lambda key, payload, to=releases[name]: to.append(payload)
        )
        live.session.subscribe(f"{clock.DONE}/{name}", lambda key, payload, to=tokens[name]: to.append(payload))
    live.begin(b"forward")
    live.wait(lambda: live.t() >= 0.3)
    for name in releases:
        for payload in forged_releases(releases[name]):
            live.session.put(f"{clock.RELEASE}/{name}", payload)
    for name in releases:
        reported(live, name, "clock/release.*")
    for name in releases:
        for payload in forged_tokens(tokens[name], round(live.t() * NS)):
            live.session.put(f"{clock.DONE}/{name}", payload)
    reported(live, "io", r"clock/done.*")
    for name in releases:
        hellos = (clock.pack_hello(clock.Hello(0)), clock.pack_hello(clock.Hello(0, new=False)))
        others = (msgpack.packb(each) for each in (-1, "a", None, 1.5, [0], [0, 1], [-1, True], [0, True, 0]))
        for payload in (*hellos, *others, *MAD):
            live.session.put(f"{clock.HELLO}/{name}", payload)
    reported(live, "io", r"clock/hello.*")
    live.go_on(0.1)
    assert_same_bytes(live)


def test_a_second_who_answers_for_what_was_published_does_not_mislead_a_process_that_takes_up(stack):
    live = stack(leave_out=("trajopt",))
    live.begin(b"forward")
    live.wait(lambda: live.t() >= 0.3)
    for key in KEYS:
        lie = other(live.last(key)) if live.heard[key] else TOPICS[key].message()
        lies = [*MAD, *(encode(replace(lie, seq=seq)) for seq in range(400))]
        live.session.serve(f"{clock.KEPT}/{key}", lambda lies=lies: lies)
    live.restart("estimator")
    reported(live, "estimator", "(hw/state|fsm/reference): kept by a second publisher")
    live.go_on(0.1)
    assert_same_bytes(live)
