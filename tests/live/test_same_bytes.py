"""Seven processes over Zenoh with simulated time publish the same bytes as one process does."""

from dataclasses import replace

import numpy as np

from surefoot.bus.codec import decode, encode
from surefoot.bus.messages import LegStatus
from surefoot.bus.topics import TOPICS
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


def test_over_the_bus_and_in_one_process_give_the_same_bytes(stack):
    live = stack(("run.vision=true",), leave_out=("trajopt",))
    live.begin(b"forward")
    live.wait(lambda: live.t() >= UNTIL_S)
    expected = local_bytes(live.deployment, UNTIL_S)
    other = local_bytes(replace(live.deployment, hw=replace(live.deployment.hw, seed=1)), 0.1)
    with live.lock:
        heard = {key: list(payloads) for key, payloads in live.heard.items()}
    for key in KEYS:
        want = expected[key]
        kind = TOPICS[key].message
        got = [encode(decode(kind, payload), volatile=False) for payload in heard[key][: len(want)]]
        differing = [index for index, pair in enumerate(zip(got, want, strict=True)) if pair[0] != pair[1]]
        assert not differing, f"{key} differs first at message {differing[0]} of {len(want)}"
    seen = np.array(
        [decode(TOPICS["fsm/reference"].message, payload).leg_status for payload in expected["fsm/reference"]]
    )
    assert (seen == LegStatus.SWING).any() and (seen == LegStatus.PROBING).any()
    assert all(expected[key] for key in ("hw/depth", "map/elevation", "foothold/regions", "trajopt/plan"))
    assert other["hw/state"] != expected["hw/state"][: len(other["hw/state"])]
