"""What the view makes of the state machine's events, told one by one."""

import numpy as np
import pytest

from surefoot.bus.messages import FootholdRequest, FsmEvent, Plan
from surefoot.tools.view.history import History
from surefoot.tools.view.palette import Verdict

FOOTHOLD = np.array([0.4, -0.14, 0.026])
FRONT = FOOTHOLD + [0.025, 0.0, 0.0]


def event(kind, p=FOOTHOLD, state="PROBE", leg=1, **figures):
    return FsmEvent(kind=kind, state=state, leg=leg, p_WF=np.array(p), **figures)


def told(*messages):
    history = History()
    for message in messages:
        history.note(message)
    return history


SEND = event("transition", state="SEND")
CONTACT = event("contact", state="DETECT_CONTACT")
HELD = event("force_held", force_index=2, asked_n=90.0, held_n=88.0, displacement_m=0.004)


def test_a_place_is_probed_from_contact_on_and_holds_what_it_bore():
    (spot,) = told(SEND, CONTACT).spots
    assert spot.verdict == Verdict.PROBING and spot.held_n == 0.0
    (spot,) = told(SEND, CONTACT, HELD, event("accepted", held_n=88.0)).spots
    assert spot.verdict == Verdict.HELD and spot.held_n == 88.0


def test_a_foot_that_went_down_with_the_ground_has_not_found_another_place():
    history = told(
        SEND, CONTACT, event("collapse", FOOTHOLD - [0.0, 0.0, 0.03], asked_n=105.0, reason="moved 3 cm")
    )
    (spot,) = history.spots
    assert spot.verdict == Verdict.COLLAPSED and spot.held_n == 105.0 and spot.p_W is CONTACT.p_WF
    assert history.candidates[0].verdict == Verdict.COLLAPSED and history.candidates[0].outcome == "moved 3 cm"


def test_points_around_are_places_of_their_own_and_the_foot_comes_back_to_the_foothold():
    hop = event("contact", FRONT, "PROBE_AROUND", around=1)
    back = event("contact", FOOTHOLD + 0.001, "PROBE_AROUND", around=5)
    history = told(
        SEND, CONTACT, HELD, hop, HELD, back, event("accepted", FOOTHOLD + 0.001, around=5, held_n=88.0)
    )
    assert [(spot.around, spot.verdict) for spot in history.spots] == [(0, Verdict.HELD), (1, Verdict.HELD)]


def test_a_step_that_is_not_probed_leaves_its_foothold_untested():
    (spot,) = told(SEND, CONTACT, event("accepted", reason="contact; probing is off")).spots
    assert spot.verdict == Verdict.UNTESTED


def test_ground_that_gives_way_later_is_told_of_the_same_place():
    history = told(SEND, CONTACT, HELD, event("accepted", held_n=88.0), event("late_collapse", held_n=130.0))
    (spot,) = history.spots
    assert spot.verdict == Verdict.COLLAPSED and spot.held_n == 130.0


def test_candidates_lie_where_request_and_plan_have_them_and_keep_their_reasons():
    targets = np.zeros((4, 3))
    targets[1] = FOOTHOLD
    planned = targets + 0.01
    history = told(
        SEND,
        FootholdRequest(target_WF=targets),
        event("rejected", state="SEND", reason="out of reach at every base height"),
        event("transition", state="SEND", candidate=1),
        FootholdRequest(target_WF=targets + 0.07),
        Plan(status="ok", footholds_WF=planned),
    )
    first, second = history.candidates[0], history.candidates[1]
    assert first.outcome == "out of reach at every base height" and first.p_W == pytest.approx(FOOTHOLD)
    assert second.verdict == Verdict.UNTESTED and second.p_W == pytest.approx(planned[1])


def test_another_turn_forgets_the_candidates_and_the_plan_but_no_place():
    history = told(SEND, CONTACT, Plan(status="ok"), event("transition", state="SEND", leg=2))
    assert history.leg == 2 and history.candidates == {} and history.plan is None and len(history.spots) == 1


def test_a_foot_in_the_air_has_no_place_to_be_displaced_from():
    assert told(SEND, CONTACT).touch_W is CONTACT.p_WF
    assert told(SEND, CONTACT, event("transition", state="LEG_UP")).touch_W is None
