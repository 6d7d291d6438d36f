"""The settings of a running stack, changed in a real browser."""

import threading
import tomllib

import pytest
from driven import Driven

from surefoot.bus.codec import decode
from surefoot.bus.messages import Tuning
from surefoot.tools.teleop.remote import Remote
from surefoot.tools.view.bus_source import BusSource
from surefoot.tools.view.page import Page


@pytest.fixture
def stack():
    made = Driven()
    made.come_to("STAND")
    yield made
    made.close()


@pytest.fixture
def session(stack):
    made = stack.join()
    yield made
    made.close()


@pytest.fixture
def shown(stack, tab):
    """The page of that stack, with the folder open."""
    page, over = Page(BusSource(stack.join, wait=False), port=0), threading.Event()
    thread = threading.Thread(target=page.run, args=(over.is_set,))
    thread.start()
    tab.goto(page.url)
    tab.get_by_text("Tuning", exact=True).click()
    yield tab
    over.set()
    thread.join()
    page.close()


def put(tab, name, value):
    tab.get_by_label(name, exact=True).fill(value)
    tab.get_by_role("button", name=f"set {name} = {value}").click()


def wait_for_value(tab, name, value):
    field = tab.get_by_label(name, exact=True)
    tab.wait_for_function("([field, value]) => field.value === value", arg=[field.element_handle(), value])


def test_a_change_is_a_request_on_the_bus_and_what_is_refused_springs_back(shown, session, stack):
    heard = []
    session.subscribe("operator/tuning", lambda key, payload: heard.append(decode(Tuning, payload).assignment))
    put(shown, "swing_s", "0.42")
    shown.get_by_text("fsm.swing_s=0.42 from the next step on").wait_for()
    shown.get_by_label("● swing_s").wait_for()
    stack.wait(lambda: stack.robot.fsm.deployment.fsm.swing_s == 0.42)
    put(shown, "step_m", "0.01")
    shown.get_by_text("step_min_m = 0.05 is not below step_m = 0.01").wait_for()
    wait_for_value(shown, "step_m", "0.1")
    assert heard == [("fsm.swing_s=0.42",)]


def test_what_another_hand_has_changed_is_seen_saved_and_put_back(shown, session, stack):
    remote = Remote(session, beats=False)
    assert remote.tune("fsm.collapse_m", 0.025).taken and remote.tune("wbc.kp", 90.0).taken
    wait_for_value(shown, "● collapse_m", "0.025")
    shown.get_by_text("90.0, was 100.0").wait_for()
    with shown.expect_download() as download:
        shown.get_by_text("save", exact=True).click()
    text = download.value.path().read_text()
    saved = tomllib.loads(text)
    assert saved["fsm"]["collapse_m"] == 0.025 and saved["wbc"]["kp"] == 90.0
    assert "collapse_m = 0.025  # tuned; the run began with 0.03" in text
    shown.get_by_text("put back", exact=True).click()
    shown.get_by_text("all is as the run began").wait_for()
    wait_for_value(shown, "collapse_m", "0.03")
    stack.wait(lambda: stack.robot.fsm.deployment == stack.robot.fsm._original)
