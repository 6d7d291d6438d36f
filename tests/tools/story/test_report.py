"""The page of a run says what the recording says."""

import pytest
import scenes
from html_page import Page

from surefoot.bus.messages import FsmEvent, HardwareState, MotionReference
from surefoot.config.deployment import Deployment
from surefoot.config.typed_toml import to_table
from surefoot.tools.cli import main
from surefoot.tools.picture import Picture
from surefoot.tools.story.ending import ending
from surefoot.tools.story.settings import own_settings


def page_of(name, out):
    assert main(["report", str(scenes.path(name)), "--out", str(out)]) == 0
    html = (out / "index.html" if out.is_dir() else out).read_text()
    return html, " ".join(" ".join(Page(html).text).split())


def test_the_story_of_a_collapse(tmp_path, capsys):
    html, text = page_of("collapse", tmp_path / "page")
    assert text.startswith("collapse.mcap: the recording ends while the robot is in DETECT_CONTACT")
    assert "only digests of 94 messages" in text
    assert "FR planned 0.44, -0.15 1 94 30 collapse – the foot moved 3.0 cm, limit 3.0 cm" in text
    assert "FR alternative 1" in text and "The first collapse" in text
    assert "23.18 s FR collapse: the foot moved 3.0 cm" in text
    assert "terrain.kind planks flat" in text and "The whole configuration" in text
    assert html.count("<svg ") == 4  # path, states, the collapse, support
    assert "Estimate and truth" not in text and "left out: " in capsys.readouterr().out
    assert "http" not in html.replace("http://www.w3.org", "")  # names of a namespace, no links


def test_a_run_without_a_probe_says_so(tmp_path):
    _, text = page_of("stand", tmp_path / "stand.html")
    assert "No foot was set down to probe." in text and "The first" not in text
    assert "told to forward" in text


def test_why_it_ended_is_what_a_supervisor_would_have_said():
    walked = Picture()
    walked.note_command("forward")
    walked.reference = MotionReference(state="STOPPED", reason="the goal is reached", finished=True)
    assert ending(walked, "planks").reason == "platform crossed" and ending(walked, "planks").good
    stuck = Picture(reference=MotionReference(state="STOPPED", reason="no safe foothold for FL"))
    assert ending(stuck, "planks").reason == "the robot stopped: no safe foothold for FL"
    assert "surefoot command backward" in ending(stuck, "planks").advice
    latched = Picture(
        reference=MotionReference(state="STAND"),
        hardware=HardwareState(damping=True, gate="tilted: latched until `surefoot command sit`, then `stand`"),
    )
    latched.note_event(FsmEvent(kind="transition"))
    assert ending(latched, "flat").reason != ""
    assert "nothing of the state machine" in ending(Picture(), "flat").reason


def test_only_settings_that_were_changed_are_listed():
    config = to_table(Deployment())
    assert own_settings(config) == []
    config["fsm"]["step_m"] = 0.08
    config["fsm"]["of_another_version"] = 3
    assert own_settings(config) == [("fsm.step_m", "0.08", "0.1"), ("fsm.of_another_version", "3", "–")]


@pytest.mark.parametrize(
    ("call", "words"),
    [
        ([str(scenes.path("stand")), "--out", "a.pdf"], "a page ends in .html"),
        ([str(scenes.path("stand")), "--out", "/nowhere/a.html"], "there is no folder /nowhere"),
        ([__file__, "--out", "a.html"], "not a recording"),
    ],
)
def test_a_wrong_call_is_answered_by_what_would_be_right(call, words, capsys):
    assert main(["report", *call]) == 2
    assert words in capsys.readouterr().err
