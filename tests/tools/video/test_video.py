"""A film shows the recording from its first instant to its last, frame by frame."""

import sys

import numpy as np
import pytest
import scenes
from made_recording import OFF_M, with_truth

from surefoot.config.typed_toml import ConfigError
from surefoot.hw.mujoco.backend import MujocoRobot
from surefoot.tools.cli import main
from surefoot.tools.offscreen import NO_RENDERER, Offscreen
from surefoot.tools.tables.recording_tables import load
from surefoot.tools.video.film import FilmSpec, make_film
from surefoot.tools.video.scenes import Scenes, frame_times

CLIP = scenes.path("collapse")
SMALL = ("--size", "192x128", "--fps", "10")


def film(out, *words, recording=CLIP):
    """Frames (n, height, width, 3) of a film; skips where nothing can draw."""
    av = pytest.importorskip("av")
    code = main(["video", str(recording), "--out", str(out), *SMALL, *words])
    if code == 2 and not out.exists():
        pytest.skip("no renderer on this machine")
    with av.open(str(out)) as container:
        stream = container.streams.video[0]
        return stream.average_rate, [frame.to_ndarray(format="rgb24") for frame in container.decode(stream)]


def test_instants_are_as_far_apart_as_the_film_asks():
    np.testing.assert_allclose(frame_times(1.0, 2.0, fps=10, speed=2.0), [1.0, 1.2, 1.4, 1.6, 1.8, 2.0])
    assert len(frame_times(23.0, 23.9, fps=30, speed=1.0)) == 28


def test_without_truth_the_estimate_is_shown():
    recording = load(CLIP)
    shown = Scenes(recording, frame_times(23.1, 23.9, 10, 1.0))
    estimate = recording["state/estimate"]
    for instant in shown:
        (row,) = estimate.at(np.array([instant.t]))
        expected = np.concatenate([estimate[field][row] for field in ("p_WB", "quat_WB", "q")])
        np.testing.assert_array_equal(instant.qpos, expected)
        np.testing.assert_array_equal(instant.force_W, estimate["force_W"][row])
        assert ("shown", "estimate") in instant.lines
    assert [dict(instant.lines)["state"] for instant in shown][0::5] == ["PROBE", "OPT"]
    assert shown[0].leg == 1 and shown[0].verdicts == () and shown[2].verdicts[0][1] == "collapse"


def test_with_truth_the_truth_is_shown_and_the_terrain_as_it_moved(tmp_path):
    recording = load(with_truth(tmp_path / "a.mcap", terrain_q=[0.1, 0.2]))
    shown = Scenes(recording, frame_times(23.2, 23.4, 10, 1.0))
    assert shown.true and dict(shown[0].lines)["shown"] == "truth"
    np.testing.assert_array_equal(shown[0].qpos[19:], [0.1, 0.2])
    estimate = recording["state/estimate"]
    (row,) = estimate.at(np.array([23.2]))
    np.testing.assert_allclose(shown[0].qpos[:3], estimate["p_WB"][row] - OFF_M)


def test_a_film_has_its_frames_and_something_moves_in_it(tmp_path, capsys):
    rate, frames = film(tmp_path / "a.mp4", "--from", "23.1", "--until", "23.9")
    assert rate == 10 and len(frames) == 9
    assert frames[0].shape == (128, 192, 3) and frames[0].std() > 20.0
    changed = np.abs(frames[0].astype(int) - frames[-1]).max(axis=2) > 30
    assert 0.005 < changed.mean() < 0.6
    assert "9 frames of the estimate" in capsys.readouterr().out


def test_a_faster_film_is_shorter(tmp_path):
    _, frames = film(tmp_path / "a.mp4", "--from", "23.1", "--until", "23.9", "--speed", "4")
    assert len(frames) == 3


def test_a_plank_that_was_down_is_seen_down(tmp_path):
    planks = len(MujocoRobot(load(CLIP).deployment).truth().terrain_q)
    level = with_truth(tmp_path / "level.mcap", terrain_q=np.zeros(planks), every=5)
    down = with_truth(tmp_path / "down.mcap", terrain_q=np.full(planks, 0.8), every=5)
    span = ("--from", "23.3", "--until", "23.35")
    (first, *_), (second, *_) = (
        film(path.with_suffix(".mp4"), *span, recording=path)[1] for path in (level, down)
    )
    assert (np.abs(first.astype(int) - second).max(axis=2) > 30).mean() > 0.01


def test_a_scene_of_other_settings_is_told(tmp_path, capsys):
    recording = with_truth(tmp_path / "a.mcap", terrain_q=[0.1])
    out = tmp_path / "a.mp4"
    assert main(["video", str(recording), "--out", str(out), *SMALL, "--from", "23.3", "--until", "23.35"]) == 2
    told = capsys.readouterr().err
    if NO_RENDERER not in told and "no renderer" in told:
        pytest.skip(told)
    assert "20 positions for a scene of" in told and not out.exists()


def test_where_nothing_can_draw_it_says_what_to_install(tmp_path, monkeypatch):
    monkeypatch.delenv("MUJOCO_GL", raising=False)
    spec = FilmSpec(CLIP, tmp_path / "a.mp4", begin_s=23.3, end_s=23.35)
    with pytest.raises(ConfigError, match=r"no renderer on this machine \(chalk: .*apt install libegl1"):
        make_film(spec, print, Offscreen(["chalk"]))
    assert list(tmp_path.iterdir()) == []


def test_without_an_encoder_the_remedy_is_named(tmp_path, monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "av", None)
    assert main(["video", str(CLIP), "--out", str(tmp_path / "a.mp4")]) == 2
    assert "pip install 'surefoot[video]'" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--size", "big"], "--size big: want WIDTHxHEIGHT"),
        (["--size", "641x480"], "width 641: an even number from 64 to 3840 pixels"),
        (["--size", "640x9000"], "height 9000: an even number"),
        (["--speed", "0"], "--speed 0: allowed 0.01 to 100"),
        (["--fps", "0"], "--fps 0: allowed 1 to 120"),
        (["--from", "99"], "nothing from 99 to inf s; it is of 21.202 to 23.940 s"),
        (["--out", "a.avi"], "a film is an .mp4"),
        (["--out", "/nowhere/a.mp4"], "there is no folder /nowhere"),
    ],
)
def test_a_wrong_call_is_answered_by_what_would_be_right(words, told, capsys, tmp_path):
    out = [] if "--out" in words else ["--out", str(tmp_path / "a.mp4")]
    assert main(["video", str(CLIP), *out, *words]) == 2
    assert told in capsys.readouterr().err


def test_another_file_is_refused(capsys, tmp_path):
    assert main(["video", __file__, "--out", str(tmp_path / "a.mp4")]) == 2
    assert "not a recording" in capsys.readouterr().err
