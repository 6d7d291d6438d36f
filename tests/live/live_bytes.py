"""What a run publishes, byte by byte: over the bus, and in one process."""

from dataclasses import replace

import numpy as np

from surefoot.bus.codec import decode, encode
from surefoot.bus.topics import TOPICS
from surefoot.components.lockstep import Lockstep

KEYS = [key for key in TOPICS if not key.startswith("status/")]


def local_bytes(deployment, until_s, command="forward", tunings=()):
    """Messages of each topic of a run in one process, in which settings are changed at times (t, assignment)."""
    stack = Lockstep(deployment)
    heard = {key: [] for key in KEYS}
    stack.listen(lambda key, message: heard[key].append(encode(message, volatile=False)) if key in heard else None)
    stack.command(command)
    for t, assignment in tunings:
        stack.run(t)
        stack.tune(assignment)
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


def assert_same_bytes(live):
    """What has been heard so far is what one process publishes, but for the last instants."""
    live.stand_still()
    expected = local_bytes(live.deployment, live.t() - 0.05)
    live.wait(lambda: all(len(live.heard[key]) >= len(want) for key, want in expected.items()))  # on their way
    with live.lock:
        heard = {key: list(payloads) for key, payloads in live.heard.items()}
    difference = first_difference(heard, expected)
    assert difference == "", difference


def assert_same_bytes_as_far_as_heard(live, until_s):
    """What has been heard is what one process publishes; the hub may have cut off or taken on a session meanwhile.

    Then a listener may miss a message, also of the same machine; unlike the processes this one does not ask
    again. A reader that had missed one would have changed all that follows.
    """
    expected = local_bytes(live.deployment, until_s)
    with live.lock:
        heard = {key: list(payloads) for key, payloads in live.heard.items()}
    for key, want in expected.items():
        seen = set()
        for message in (decode(TOPICS[key].message, payload) for payload in heard[key]):
            if message.seq < len(want):
                seen.add(message.seq)
                assert encode(message, volatile=False) == want[message.seq], f"{key}, message {message.seq}"
        assert len(want) < 20 or (len(seen) > 0.9 * len(want) and max(seen) > len(want) - 5), key
