"""What stands beside the picture."""

from dataclasses import replace

import pytest
import scenes

from surefoot.bus.messages import FsmEvent, HardwareState, ProcessStatus, Tuning
from surefoot.config.deployment import Deployment
from surefoot.tools.picture import Picture
from surefoot.tools.teleop.tuned_run import TunedRun
from surefoot.tools.view import panel_text
from surefoot.tools.view.heard import Heard
from surefoot.tools.view.recording_source import RecordingSource


@pytest.fixture(scope="module")
def source():
    return RecordingSource(scenes.path("collapse"))


def at(source, t):
    source.seek(t)
    return source.heard


def test_the_machine_says_state_leg_candidate_margin_and_pace(source):
    text = panel_text.machine(at(source, 23.1), source.deployment, 0.034, "paused")
    for words in ("PROBE", "<b>FR</b>", "planned foothold", "34 mm", "paused"):
        assert words in text
    after = panel_text.machine(at(source, 23.94), source.deployment, None, "paused")
    assert "alternative 1 of 3" in after


def test_a_gate_that_damps_is_told(source):
    heard = replace(at(source, 23.1), hardware=HardwareState(damping=True, gate="no command <here>"))
    assert "the gate damps: no command &lt;here&gt;" in panel_text.machine(heard, source.deployment, None, "")


def test_six_bars_say_what_is_asked_and_held_and_the_gauge_how_far_the_foot_has_moved(source):
    heard = at(source, 23.1)
    text = panel_text.press(heard, source.deployment)
    assert text.count("of") >= 6 and "collapse at 30 mm" in text


def test_the_gauge_says_what_the_state_machine_has_measured():
    heard = at(RecordingSource(scenes.path("step")), 2.828)
    told = heard.history.events[-1]
    assert told.kind == "force_held"
    assert panel_text.displacement_m(heard) == pytest.approx(told.displacement_m, abs=1e-3)


def test_candidates_keep_the_reason_why_they_were_given_up(source):
    text = panel_text.candidates(at(source, 23.94))
    assert "leg FR" in text and "the foot moved 3.0 cm, limit 3.0 cm" in text


def test_words_of_others_are_no_html():
    heard = Heard()
    heard.history.note(FsmEvent(kind="refused", reason="<script>alert(1)</script>"))
    assert "<script>" not in panel_text.events(heard)


def test_processes_tell_what_is_the_matter():
    picture = Picture()
    picture.note_status(
        ProcessStatus(process="mpc", life="RUN", reason="riccati: node 3", rate_hz=99, nominal_hz=100)
    )
    text = panel_text.processes(picture)
    assert "99/100" in text and "mpc: riccati: node 3" in text and "absent" in text
    assert "does not hold" in panel_text.processes(None)


def test_a_change_of_the_settings_is_told_among_the_events():
    heard = Heard()
    heard.history.note(FsmEvent(t=1.0, kind="accepted", reason="it held"))
    heard.history.note(Tuning(t=2.0, assignment=("wbc.kd=21.0", "wbc.kp=90.0")))
    newest, before = panel_text.events(heard).split("<br>")
    assert "2.00 s  tuned: wbc.kp=90.0" in newest and "accepted: it held" in before


def test_what_differs_from_the_runs_beginning_is_told_with_what_it_was():
    text = panel_text.changed(TunedRun(Deployment(), ("wbc.kp=90.0", "wbc.kd=20.0")))
    assert "<b>wbc.kp</b> 90.0, was 100.0" in text and "wbc.kd" not in text
