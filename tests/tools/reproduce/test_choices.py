"""The figures show what their captions say: the right instants, the right probes, an honest sentence."""

import subprocess
import sys
from types import SimpleNamespace

import numpy as np
import pytest

from surefoot.tools.reproduce import planks
from surefoot.tools.reproduce.force_tracking import errors, probes_of
from surefoot.tools.reproduce.polygon_and_force import margins
from surefoot.tools.reproduce.run_spec import RunSpec

START_X = 0.3


def run(success=True, sim_time_s=200.0, failure=None):
    spec = RunSpec("planks", "full", 0, 1200.0, ())
    result = {"success": success, "sim_time_s": sim_time_s, "failure": failure}
    return SimpleNamespace(spec=spec, result=result, start_x=START_X, end_x=START_X + 1.0)


def instants(*rows):
    """(kind, around, foot's x, displacement) of each."""
    kind, around, x, moved = (np.array(each) for each in zip(*rows, strict=True))
    foot_W = np.column_stack([x, 0 * x, 0 * x])
    return {"kind": kind, "around": around, "foot_W": foot_W, "displacement_m": moved}


def test_a_foot_is_on_a_beam_where_a_beam_is():
    # Beams are 4 cm wide, a row is 25 cm long; the fifth would lie behind the planks.
    x = START_X + np.array([-0.01, 0.01, 0.039, 0.05, 0.24, 0.26, 0.53, 0.76, 0.80, 1.01])
    expected = [False, True, True, False, False, True, True, True, False, False]
    assert planks.on_beam(x, run()).tolist() == expected


def test_the_snapshots_follow_one_collapse_and_the_beams():
    kept = instants(
        ("tick", 0, 0.0, 0.0),
        ("accepted", 5, START_X - 0.2, 0.0),  # still on the run-up
        ("collapse", 1, START_X + 0.1, 0.03),  # around a foothold: that is (b)
        ("collapse", 0, START_X + 0.2, 0.034),
        ("leg_up", 0, START_X + 0.15, 0.034),
        ("accepted", 5, START_X + 0.22, 0.0),  # near the beam, not on it
        ("accepted", 5, START_X + 0.27, 0.0),
        ("accepted", 5, START_X + 0.77, 0.0),
        ("accepted", 5, START_X + 1.2, 0.0),  # on the run-out
        ("end", 0, 0.9, 0.0),
    )
    found = planks.traversal_rows(run(), kept)
    assert [row for row, _, _ in found] == [3, 4, 6, 7]
    assert "3.4 cm" in found[0][1] and "23 cm before their end" in found[3][1]


def test_a_run_without_a_collapse_shows_none():
    assert planks.traversal_rows(run(), instants(("tick", 0, 0.0, 0.0), ("end", 0, 0.0, 0.0))) == []


@pytest.mark.parametrize(("arounds", "expected"), [((0, 3, 1, 1), 2), ((0, 3, 4), 1), ((0, 5), -1), ((), -1)])
def test_a_collapse_in_front_is_shown_before_one_beside(arounds, expected):
    rows = [("collapse", around, 0.5, 0.03) for around in arounds] + [("accepted", 1, 0.5, 0.0)]
    assert planks.found_around(instants(*rows)) == expected


def test_the_mean_is_over_complete_traversals_only_and_says_so():
    runs = [run(sim_time_s=200.0), run(sim_time_s=220.0), run(False, 12.0, "fell")]
    assert planks.mean_time(runs, quick=False).startswith("Mean of 2 complete traversals (3 started): 210 s")
    told = planks.mean_time(runs[2:], quick=False)
    assert told.startswith("No complete traversal here: no run crossed") and "390 s (6.5 min)" in told
    assert "no run crossed" in planks.mean_time(runs[2:], quick=True)  # it fell: that is no matter of time
    late = [run(False, 40.0, "timeout")]
    assert "the quick version cuts every crossing off" in planks.mean_time(late, quick=True)
    assert "no run crossed" in planks.mean_time(late, quick=False)


def test_a_run_that_was_cut_off_has_not_failed():
    runs = [run(False, failure="timeout"), run(False, failure="fell"), run()]
    assert planks.failures(runs, quick=True) == "1 of 3" and planks.failures(runs, quick=False) == "2 of 3"


def series(rows):
    """Rows of (probe, around, pressing, margin, asked, mpc, estimated, true), forces along the normal."""
    probe, around, pressing, margin, *forces = (np.array(each) for each in zip(*rows, strict=True))
    up = np.array([0.0, 0.0, 1.0])
    found = {"probe": probe, "around": around, "pressing": pressing.astype(bool), "margin_m": margin}
    found |= {name: f[:, None] * up for name, f in zip(("asked", "mpc", "estimated", "true"), forces, strict=True)}
    return found | {"wbc": found["mpc"], "normal_W": np.tile(up, (len(rows), 1))}


def test_probes_are_told_apart_and_swings_and_points_around_left_out():
    kept = series(
        [
            (0, 0, 0, -0.5, np.nan, 0.0, 0.0, 0.0),
            (0, 0, 1, 0.03, 50.0, 50.0, 50.0, 50.0),
            (0, 0, 1, 0.02, 50.0, 48.0, 47.0, 44.0),
            (1, 2, 1, -0.01, 50.0, 50.0, 50.0, 50.0),
            (3, 0, 1, 0.01, 50.0, 50.0, 50.0, 50.0),
        ]
    )
    assert [rows.tolist() for rows in probes_of(kept)] == [[1, 2], [4]]
    assert margins(kept) == [0.02, 0.01]
    told = errors(kept)
    assert told["mpc / asked"] == pytest.approx(1.0)  # root of (2 ** 2) / 4: the swing counts for nothing
    assert told["true / mpc"] == pytest.approx(2.0) and told["estimated / true"] == pytest.approx(1.5)


def test_without_matplotlib_the_call_says_what_to_install():
    code = (
        "import sys; sys.modules['matplotlib'] = None; from surefoot.tools.cli import main;"
        "sys.exit(main(['reproduce', 'nowhere', '--quick']))"
    )
    done = subprocess.run([sys.executable, "-P", "-c", code], capture_output=True, text=True)
    assert done.returncode == 2 and "pip install 'surefoot[report]'" in done.stderr
