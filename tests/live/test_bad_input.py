"""What no process should publish is dropped, counted and reported by topic; the robot keeps standing."""

import re

import msgpack
import numpy as np
import pytest

from surefoot.bus.codec import encode
from surefoot.bus.errors import BusError
from surefoot.bus.messages import JointCommand, MotionReference, StateEstimate
from surefoot.bus.session import Session
from surefoot.bus.topics import PROCESSES
from surefoot.tools.cli import main


def with_field(message, **fields):
    return msgpack.packb({**msgpack.unpackb(encode(message)), **fields})


def test_bad_messages_are_reported_by_topic_and_change_nothing(stack):
    live = stack(leave_out=("trajopt",))
    live.begin(b"stand")
    live.wait(lambda: live.t() >= 0.3)
    reference, estimate = live.last("fsm/reference"), live.last("state/estimate")
    again = live.last("joint/command")
    bad = (
        ("fsm/reference", b"\xc1", "estimator", "not msgpack"),
        ("fsm/reference", with_field(reference, swing_t0=float("nan")), "wbc", r"swing_t0 = nan: not finite"),
        (
            "fsm/reference",
            with_field(reference, p_WF=np.zeros(9).tobytes()),
            "mpc",
            r"p_WF = 72 bytes: expected 96",
        ),
        ("state/estimate", with_field(estimate, q=np.full(12, np.inf).tobytes()), "fsm", r"StateEstimate\.q"),
        (
            "mpc/policy",
            encode(JointCommand(t=0.3, valid=True, q=np.ones(12))),
            "wbc",
            "says 'JointCommand': another type",
        ),
        ("joint/command", encode(again) + b"\x00", "io", "not msgpack"),
        # A second publisher: what it says is well formed, but not in its place.
        (
            "joint/command",
            encode(JointCommand(t=again.t, seq=3, valid=True, tau=np.full(12, 30.0))),
            "io",
            "second",
        ),
        ("fsm/reference", encode(MotionReference(seq=10**9, valid=True)), "mpc", "second"),
        ("state/estimate", encode(StateEstimate(seq=0, valid=True)), "fsm", "second"),
    )
    for key, payload, reader, words in bad:
        before = live.status[reader].bad_messages
        live.session.put(key, payload)
        live.wait(
            lambda key=key, reader=reader, words=words: (
                re.search(f"{key}: .*{words}", live.reason(reader)) is not None
            )
        )
        assert live.status[reader].bad_messages > before
        live.go_on(0.05)
        assert live.stands(), f"after {words} on {key}"
    live.go_on(0.5)
    assert live.stands()


def test_no_hub_is_a_clear_error():
    with pytest.raises(BusError, match="surefoot run"):
        Session("nobody-listens-here", connect_ms=300)


def test_a_second_hub_or_run_of_one_namespace_is_refused(stack, capsys):
    live = stack(leave_out=tuple(name for name in PROCESSES if name != "io"))
    with pytest.raises(BusError, match=r"already serves"):
        Session(live.namespace, hub=True)
    assert main(["run", "flat", "--plain", "--set", f"run.namespace={live.namespace}"]) == 2
    assert f"process {live.children['io'].pid} already serves" in capsys.readouterr().err
