"""Seven processes over Zenoh with simulated time publish the same bytes as one process does."""

from dataclasses import replace

import numpy as np
from live_bytes import KEYS, first_difference, local_bytes

from surefoot.bus.codec import decode
from surefoot.bus.messages import LegStatus
from surefoot.bus.topics import PROCESSES, TOPICS

UNTIL_S = 2.9  # plans a stride, shifts its base, lifts a foot off, touches down and begins to probe


def test_over_the_bus_and_in_one_process_give_the_same_bytes(stack):
    live = stack(("run.vision=true", "mpc.profile=paper"), leave_out=("trajopt",))
    live.begin(b"forward")
    live.wait(lambda: live.t() >= UNTIL_S + 0.05)
    live.stand_still()
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
    live.stand_still()
    end = live.t() - 0.1
    expected = local_bytes(live.deployment, end)
    with live.lock:
        heard = {key: list(payloads) for key, payloads in live.heard.items()}
    assert first_difference(heard, expected) == ""
    assert decoded(heard, "fsm/reference")[-1].boot == decoded(heard, "joint/command")[-1].boot == 3
    assert not any(status.bad_messages for status in live.status.values())
