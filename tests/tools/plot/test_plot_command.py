"""`surefoot plot` writes what its ending says, and answers a wrong call by what would be right."""

from xml.etree import ElementTree

import pytest
import scenes
from html_page import Page

from surefoot.tools.cli import main

CLIP = str(scenes.path("collapse"))


def test_a_picture_is_a_png_an_svg_or_a_page(tmp_path, capsys):
    for ending in ("png", "svg", "html"):
        call = ["plot", CLIP, "--what", "displacement", "--out", str(tmp_path / f"a.{ending}")]
        assert main(call) == 0
    assert "missing: mpc/policy: only digests" in capsys.readouterr().out
    assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")
    assert ElementTree.parse(tmp_path / "a.svg").getroot().tag.endswith("svg")
    html = (tmp_path / "a.html").read_text()
    page = Page(html)
    assert "collapse.mcap: Force against displacement" in " ".join(page.text)
    assert html.count("<svg ") == 1 and not page.sources


def test_the_same_recording_gives_the_same_picture(tmp_path):
    for name in ("a.svg", "b.svg"):
        assert main(["plot", CLIP, "--what", "states", "--out", str(tmp_path / name)]) == 0
    assert (tmp_path / "a.svg").read_bytes() == (tmp_path / "b.svg").read_bytes()


def test_half_a_recording_is_drawn_as_far_as_it_goes(tmp_path, capsys):
    whole = scenes.path("collapse").read_bytes()
    (tmp_path / "cut.mcap").write_bytes(whole[: len(whole) * 9 // 10])
    out = tmp_path / "cut.png"
    assert main(["plot", str(tmp_path / "cut.mcap"), "--what", "path", "--out", str(out)]) == 0
    assert "missing: the file is incomplete: it ends in the middle of a record" in capsys.readouterr().out
    assert out.stat().st_size > 10_000


@pytest.mark.parametrize(
    ("call", "words"),
    [
        ([CLIP, "--what", "torques"], "--what torques: no such picture; there are probing, forces"),
        ([CLIP, "--leg", "LF"], "--leg LF: no such leg; there are FL, FR, RL, RR"),
        ([CLIP, "--leg", "RL"], "no probe of RL in this recording; there are probes of FR"),
        ([CLIP, "--probe", "7"], "no probe 7 in this recording; there are 1 to 2"),
        ([CLIP, "--probe", "-1"], "--probe -1: probes are counted from 1"),
        ([CLIP, "--probe", "2"], "no foot has pressed in what was chosen (FR at"),
        ([CLIP, "--out", "a.pdf"], "--out a.pdf: a picture ends in .png, .svg, .html"),
        ([CLIP, "--out", "/nowhere/a.png"], "there is no folder /nowhere"),
        ([__file__], "not a recording"),
        (["none.mcap"], "no such file: none.mcap"),
    ],
)
def test_a_wrong_call_is_answered_by_what_would_be_right(call, words, capsys, tmp_path):
    out = [] if "--out" in call else ["--out", str(tmp_path / "a.png")]
    assert main(["plot", *call, *out]) == 2
    assert words in capsys.readouterr().err
