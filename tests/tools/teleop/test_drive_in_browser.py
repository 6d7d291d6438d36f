"""The page of `surefoot drive --browser` in a real browser, with a gamepad that the test holds."""

from contextlib import ExitStack

import pytest
from driven import PATIENCE_S, served

GAMEPAD = """
window.hold = (x, y, ...down) => { window.held = {
  id: "Test pad", connected: true, mapping: "standard", axes: [x, y, 0, 0],
  buttons: Array.from({ length: 17 }, (_, number) => ({ pressed: down.includes(number) })),
}; };
window.held = null;
navigator.getGamepads = () => [window.held];
window.hide = away => {
  Object.defineProperty(document, "hidden", { value: away, configurable: true });
  document.dispatchEvent(new Event("visibilitychange"));
};
"""
B = 1


@pytest.fixture
def driven(tab):
    """Makes a stack, and the page that drives it in a tab."""
    with ExitStack() as made:

        def make(**settings):
            stack, page = made.enter_context(served(**settings))
            tab.add_init_script(GAMEPAD)
            tab.goto(page.url)
            tab.get_by_text("connected to").wait_for()
            return stack, page

        yield make
        tab.close()


def test_the_gamepad_the_keys_and_the_buttons_drive_and_the_page_shows_the_answers(driven, tab, tmp_path):
    requested = []
    tab.on("request", lambda request: requested.append(request.url))
    stack, page = driven()
    stack.hold_in("DETECT_CONTACT")
    tab.get_by_text("no gamepad: plug it in").wait_for()
    tab.evaluate("hold(0, 0)")
    tab.get_by_text("gamepad: Test pad").wait_for()
    tab.evaluate("hold(0, -1)")
    stack.wait_held()
    tab.get_by_text("DETECT_CONTACT", exact=True).wait_for()
    tab.evaluate("hold(0, 0)")
    tab.get_by_text("halt: after the step of RL; the walk is over").wait_for()
    tab.keyboard.press("n")
    tab.get_by_text("refused step: the walk ends with this step").wait_for()
    tab.screenshot(path=tmp_path / "driven.png", full_page=True)
    tab.evaluate(f"hold(0, 0, {B})")
    tab.get_by_text("stop: ").wait_for()
    tab.get_by_role("button", name="cut X").click()
    tab.get_by_text("CUT takes the torque away").wait_for()
    tab.screenshot(path=tmp_path / "asked.png", full_page=True)
    tab.get_by_role("button", name="yes, cut").click()
    tab.get_by_text("cut: no torque before damp is said").wait_for()
    assert stack.commands == ["direction 1.00 0.00", "halt", "step", "stop", "cut"]
    assert all(url.startswith((page.url, page.url.replace("http", "ws"), "data:")) for url in requested), requested


def test_a_gamepad_that_is_unplugged_halts_what_its_stick_led(driven, tab, tmp_path):
    stack, _ = driven()
    tab.evaluate("hold(0, 0)")
    tab.get_by_text("gamepad: Test pad").wait_for()
    tab.evaluate("hold(-1, 0)")
    stack.wait(lambda: stack.commands)
    tab.evaluate("held = null")
    tab.get_by_text("The gamepad is gone. A walk that its stick led is halted.").wait_for()
    stack.wait(lambda: stack.commands[1:])
    assert stack.commands == ["direction 0.00 1.00", "halt"]


def test_a_second_page_is_told_and_one_that_is_hidden_gives_up_the_seat(driven, tab, browser):
    stack, page = driven()
    other = browser.new_page()
    other.set_default_timeout(1e3 * PATIENCE_S)
    other.goto(page.url)
    other.get_by_text("not connected: another page drives this robot").wait_for()
    tab.evaluate("hide(true)")
    tab.get_by_text("not connected: this page was hidden").wait_for()
    other.get_by_role("button", name="drive from here").click()
    other.get_by_text("connected to").wait_for()
    other.close()
    tab.evaluate("hide(false)")
    tab.get_by_text("connected to").wait_for()
    tab.keyboard.press("ArrowLeft")
    stack.wait(lambda: stack.commands == ["left"])


def test_a_page_that_is_closed_is_no_heartbeat(driven, tab):
    stack, _ = driven(heartbeat_s=16.0)
    tab.get_by_text("16 s later the robot sits down").wait_for()
    tab.keyboard.press("w")
    stack.wait(lambda: stack.commands)
    tab.close()
    stack.wait(lambda: stack.commands[1:])
    assert stack.commands == ["forward", "sit: no heartbeat for 16 s"]
