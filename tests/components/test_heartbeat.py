"""Only the time without a beat counts, and it is told once."""

from surefoot.components.heartbeat import Heartbeat


class Clock:
    t = 100.0

    def __call__(self):
        return self.t


def test_a_beat_that_ends_is_lost_once_and_missing_until_the_next():
    clock = Clock()
    heart = Heartbeat(2.0, clock)
    assert heart.missing == "no heartbeat yet" and heart.lost() == ""
    heart.beat()
    clock.t += 1.9
    assert heart.missing == "" and heart.lost() == ""
    clock.t += 0.2
    assert heart.lost() == heart.missing == "no heartbeat for 2 s"
    assert heart.lost() == "" and heart.missing
    heart.beat()
    assert not heart.missing
    clock.t += 2.1
    assert heart.lost()


def test_where_none_is_asked_for_none_is_missed():
    clock = Clock()
    heart = Heartbeat(0.0, clock)
    heart.beat()
    clock.t += 1e6
    assert heart.missing == heart.lost() == ""
