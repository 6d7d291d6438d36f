"""A cycle that was missed is left out, not made up."""

from surefoot.hw.aliengo.deadlines import Deadlines


def test_deadlines_do_not_drift_with_late_wakings():
    deadlines = Deadlines(2.0, 10.0)
    assert [deadlines.following(now) for now in (10.1, 12.9, 14.3)] == [(12.0, 0), (14.0, 0), (16.0, 0)]


def test_what_passed_is_skipped_and_counted():
    deadlines = Deadlines(2.0, 10.0)
    assert deadlines.following(17.0) == (18.0, 3)
    assert deadlines.following(18.1) == (20.0, 0)
    assert deadlines.following(22.0) == (24.0, 1)
