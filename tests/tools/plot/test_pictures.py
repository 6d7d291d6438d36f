"""What is drawn are the numbers of the recording."""

import numpy as np
import pytest
import scenes
from made_recording import OFF_M, with_statuses, with_truth

from surefoot.bus.codec import decode
from surefoot.bus.messages import MotionReference, StateEstimate
from surefoot.bus.recording.reader import Recording
from surefoot.components.fsm.support_triangle import SupportTriangle
from surefoot.tools.picture import SupportMargin
from surefoot.tools.plot.catalogue import DRAWINGS, draw
from surefoot.tools.plot.choice import Choice
from surefoot.tools.plot.force_displacement import curve
from surefoot.tools.plot.probes import find_probes
from surefoot.tools.plot.support import margins
from surefoot.tools.plot.time_line import stretches
from surefoot.tools.reproduce.recording.forces import asked_force
from surefoot.tools.tables.recording_tables import load
from surefoot.tools.tables.table import NotRecorded

COLLAPSE = scenes.path("collapse")


def decoded(key, kind):
    return [decode(kind, item.payload) for item in Recording(COLLAPSE) if item.key == key]


def line(axes, label):
    (found,) = [each for each in axes.lines if each.get_label() == label]
    return found.get_xdata(), found.get_ydata()


def test_forces_are_those_asked_and_estimated_while_the_foot_pressed():
    normal, *_ = draw(load(COLLAPSE), "forces", Choice()).axes
    assert normal.get_title() == "FR at 23.0 s, normal"
    t, estimated = line(normal, "estimated, eq. (7)")
    told = {round(each.t, 4): each for each in decoded("state/estimate", StateEstimate)}
    asked = {round(each.t, 4): each for each in decoded("fsm/reference", MotionReference)}
    begin = min(at for at in asked if at > 23.0)
    seen = [estimate.force_W[1] @ estimate.normal_W for at, estimate in told.items() if at > 23.0]
    assert t[-1] == pytest.approx(23.18 - begin, abs=0.01)
    assert all(np.abs(np.array(seen) - value).min() < 0.5 for value in estimated)  # the normal is the reference's
    _, envelope = line(normal, "envelope, asked")
    expected = asked_force(asked[23.1], 23.1) @ asked[23.1].normal_W
    assert np.abs(envelope - expected).min() < 0.5 and envelope.max() == pytest.approx(103.0, abs=1.0)


def test_displacement_is_what_the_state_machine_saw():
    recording = load(COLLAPSE)
    probe = find_probes(recording)[0]
    estimate, reference = recording["state/estimate"], recording["fsm/reference"]
    moved_m, force_n = curve(estimate, reference, 1, probe.presses[0])
    assert moved_m[-1] == pytest.approx(probe.displacement_m, abs=1.5e-3)
    assert moved_m[0] == pytest.approx(probe.presses[0].held[0].displacement_m, abs=1.5e-3)
    assert force_n.min() > 80.0 and force_n.max() < 110.0
    axes = draw(recording, "displacement", Choice(leg=1, number=1)).axes[0]
    limit = [each.get_xdata()[0] for each in axes.lines if "a collapse" in each.get_label()]
    assert limit == [pytest.approx(1e3 * recording.deployment.fsm.collapse_m)]


def test_the_support_margin_is_that_of_the_model():
    recording = load(COLLAPSE)
    t, leg, margin_m = margins(recording, 23.01, 23.94)
    estimate, model = recording["state/estimate"], SupportMargin(recording.deployment.load_robot())
    pressing = np.flatnonzero(np.isfinite(margin_m))
    assert set(leg[pressing]) == {1} and len(pressing) > 20
    for place in pressing[::7]:
        (row,) = estimate.at(t[place : place + 1])
        com = model.com(estimate["p_WB"][row], estimate["quat_WB"][row], estimate["q"][row])
        assert margin_m[place] == pytest.approx(SupportTriangle(estimate["p_WF"][row], 1).margin(com[:2]))


def test_with_truth_the_margin_is_the_true_one(tmp_path):
    recording = load(with_truth(tmp_path / "a.mcap"))
    t, _, margin_m = margins(recording, 23.01, 23.94)
    truth = recording["sim/truth"]
    place = int(np.flatnonzero(np.isfinite(margin_m))[3])
    (row,) = truth.at(t[place : place + 1])
    expected = SupportTriangle(truth["p_WF"][row], 1).margin(truth["com_W"][row, :2])
    assert margin_m[place] == pytest.approx(expected)
    assert "(truth)" in draw(recording, "support", Choice()).axes[0].get_title()


def test_states_follow_one_another():
    found = stretches(load(scenes.path("probe_holds")), 7.0)
    assert [each.state for each in found] == ["PROBE", "PROBE_AROUND", "PRE_OPT", "SEND", "OPT", "MOVE"]
    assert found[1].begin_t == pytest.approx(7.548) and found[1].end_t == found[2].begin_t
    assert found[0].leg == found[1].leg == 2 and found[-1].leg == 0 and found[-1].reason == "base shift for FL"


def test_a_leg_has_its_own_verdicts():
    recording = load(COLLAPSE)
    marks = {
        leg: [each for each in draw(recording, "states", Choice(leg)).axes[0].lines if each.get_marker() == "X"]
        for leg in (-1, 1)
    }
    (at,) = [each.get_xdata()[0] for each in marks[1] if len(each.get_xdata())]
    assert at == pytest.approx(23.18) and len(marks[-1]) == len(marks[1])
    with pytest.raises(NotRecorded, match="RL is never moved in it"):
        draw(recording, "states", Choice(leg=2))


def test_the_error_of_the_estimate_is_its_distance_from_the_truth(tmp_path):
    recording = load(with_truth(tmp_path / "a.mcap"))
    position, turned, *_ = draw(recording, "estimator", Choice(leg=1)).axes
    for axis, off in zip("xyz", OFF_M, strict=True):
        (found,) = [each for each in position.lines if each.get_label().startswith(f"{axis}, ")]
        np.testing.assert_allclose(found.get_ydata(), 1e3 * off, atol=1e-6)
    assert all(np.abs(each.get_ydata()).max() < 1e-6 for each in turned.lines)


def test_the_path_shows_every_foothold_where_it_was_tried():
    axes = draw(load(scenes.path("step")), "path", Choice()).axes[0]
    (probe,) = find_probes(load(scenes.path("step")))
    (marked,) = [each for each in axes.lines if each.get_label() == "unfinished (1)"]
    np.testing.assert_allclose(marked.get_xydata()[0], probe.p_WF[:2])
    assert len(axes.patches) > 10  # the beams and boards it was built with


def test_step_times_are_those_that_were_told(tmp_path):
    recording = load(with_statuses(tmp_path / "a.mcap", [0.4, 0.5, 0.5, 1.7]))
    axes = next(each for each in draw(recording, "timing", Choice()).axes if each.get_title())
    assert axes.get_title() == "wbc, steps: 400, 2 late"
    drawn = {container[0].get_label(): container for container in axes.collections}
    assert drawn == {} and len(axes.patches) == 3  # median, 99 of 100, longest
    assert [each.get_label() for each in axes.lines] == ["budget"]


@pytest.mark.parametrize(
    ("what", "name", "words"),
    [
        ("estimator", "collapse", "no sim/truth in it: it is of a robot, or a clip"),
        ("timing", "collapse", "nothing in it says how long anything took"),
        ("probing", "stand", "there are none at all"),
        ("support", "stand", "no time in it in which a foot is in the air"),
    ],
)
def test_what_a_recording_does_not_hold_is_named(what, name, words):
    with pytest.raises(NotRecorded, match=words):
        draw(load(scenes.path(name)), what, Choice())


def test_every_picture_is_in_the_help(capsys):
    from surefoot.tools.cli import main

    with pytest.raises(SystemExit):
        main(["plot", "--help"])
    told = capsys.readouterr().out
    assert all(f"  {name} " in told for name in DRAWINGS)
