"""A setting changed over the bus is taken at the same step as in one process, and by who is restarted later."""

from live_bytes import first_difference, local_bytes

from surefoot.bus.codec import decode
from surefoot.bus.messages import Tuning
from surefoot.bus.service_keys import TUNE

CHANGES = ("ocp.weights.force=0.015", "fsm.swing_s=0.45")


def test_a_change_and_restarts_after_it_give_the_bytes_of_one_process(stack):
    live = stack(("fsm.probe_around=false",), leave_out=("trajopt",))
    live.begin(b"forward")
    live.wait(lambda: live.t() >= 0.5 and live.last("fsm/reference").state == "STAND")
    for assignment in CHANGES:
        live.session.put(TUNE, assignment.encode())
    live.wait(lambda: len(live.heard["operator/tuning"]) == len(CHANGES))
    live.restart("fsm", "mpc", "wbc", "trajopt")
    live.wait(lambda: live.last("fsm/reference").state == "DETECT_CONTACT")
    live.stand_still()
    end = live.t() - 0.1
    with live.lock:
        messages = [decode(Tuning, payload) for payload in live.heard["operator/tuning"]]
        heard = {key: list(payloads) for key, payloads in live.heard.items()}
    tunings = [(message.t, assignment) for message, assignment in zip(messages, CHANGES, strict=True)]
    expected = local_bytes(live.deployment, end, tunings=tunings)
    assert first_difference(heard, expected) == ""
    assert first_difference(heard, local_bytes(live.deployment, end, tunings=tunings[:1])) != ""
    assert not any(status.bad_messages for status in live.status.values())
