"""Seven processes over Zenoh with simulated time publish the same bytes as one process does."""

from dataclasses import replace

import numpy as np

from surefoot.bus.codec import decode, encode
from surefoot.bus.messages import LegStatus
from surefoot.bus.topics import PROCESSES, TOPICS
from surefoot.components.lockstep import Lockstep

KEYS = [key for key in TOPICS if not key.startswith("status/")]
UNTIL_S = 2.9  # plans a stride, shifts its base, lifts a foot off, touches down and begins to probe


def local_bytes(deployment, until_s):
    stack = Lockstep(deployment)
    heard = {key: [] for key in KEYS}
    stack.listen(lambda key, message: heard[key].append(encode(message, volatile=False)) if key in heard else None)
    stack.command("forward")
    stack.run(until_s)
    return heard


def first_difference(heard, expected):
    """Where the bytes that were heard first differ from those of one process, but for `boot`; "" nowhere."""
    found = []
    for key, want in expected.items():
        kind = TOPICS[key].message
        newest = {}
        for message in (decode(kind, payload) for payload in heard[key]):
            newest[message.seq] = message  # half a step of a process that was restarted within it is repeated
        for index, payload in enumerate(want):
            wanted, got = decode(kind, payload), newest.get(index)
            if got is None:
                found.append((wanted.t, f"{key}: message {index} of {len(want)} is missing"))
            elif encode(replace(got, boot=0), volatile=False) != payload:
                names = [
                    name for name in vars(got) if not np.array_equal(getattr(got, name), getattr(wanted, name))
                ]
                found.append((wanted.t, f"{key} differs at {wanted.t:.3f} s, message {index}, in {names}"))
            else:
                continue
            break
    return "; ".join(words for _, words in sorted(found)[:3])


def test_over_the_bus_and_in_one_process_give_the_same_bytes(stack):
    live = stack(("run.vision=true",), leave_out=("trajopt",))
    live.begin(b"forward")
    live.wait(lambda: live.t() >= UNTIL_S)
    expected = local_bytes(live.deployment, UNTIL_S)
    other = local_bytes(replace(live.deployment, hw=replace(live.deployment.hw, seed=1)), 0.1)
    with live.lock:
        heard = {key: list(payloads) for key, payloads in live.heard.items()}
    assert first_difference(heard, expected) == ""
    assert not any(message.boot for key in KEYS for message in decoded(heard, key))
    seen = np.array([message.leg_status for message in decoded(expected, "fsm/reference")])
    assert (seen == LegStatus.SWING).any() and (seen == LegStatus.PROBING).any()
    assert all(expected[key] for key in ("hw/depth", "map/elevation", "foothold/regions", "trajopt/plan"))
    assert other["hw/state"] != expected["hw/state"][: len(other["hw/state"])]


def decoded(heard, key):
    """The messages of a topic."""
    return [decode(TOPICS[key].message, payload) for payload in heard[key]]


def test_restarts_change_no_byte(stack):
    """Every process but io is killed and started again while the robot stands, lifts a foot, and probes."""
    live = stack(("run.vision=true", "fsm.probe_around=false"), leave_out=("trajopt",))
    live.begin(b"forward")
    for state in ("STAND", "DETECT_CONTACT", "PROBE"):
        live.wait(lambda state=state: live.t() >= 0.5 and live.last("fsm/reference").state == state)
        live.restart(*(name for name in PROCESSES if name != "io"))
    live.go_on(0.3)
    end = live.t() - 0.1
    expected = local_bytes(live.deployment, end)
    with live.lock:
        heard = {key: list(payloads) for key, payloads in live.heard.items()}
    assert first_difference(heard, expected) == ""
    assert decoded(heard, "fsm/reference")[-1].boot == decoded(heard, "joint/command")[-1].boot == 3
    assert not any(status.bad_messages for status in live.status.values())
