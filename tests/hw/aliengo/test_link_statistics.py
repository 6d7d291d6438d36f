"""What is amiss on the link is told while it is news; the counts remember it."""

from surefoot.bus.topics import CYCLE_HZ, TOLD_S
from surefoot.hw.aliengo.link_statistics import LinkRecorder

NEWS = round(TOLD_S * CYCLE_HZ)


def cycles(recorder, count):
    for _ in range(count):
        recorder.command(0.0, None, 0)


def test_one_bad_packet_is_told_for_ten_seconds_and_counted_for_ever():
    recorder = LinkRecorder()
    cycles(recorder, 7)
    recorder.socket_error("the cable is out")
    cycles(recorder, NEWS - 1)
    assert recorder.trouble == "the cable is out"
    cycles(recorder, 1)
    found = recorder.statistics()
    assert recorder.trouble == "" and found.socket_errors == 1 and found.trouble == "the cable is out"


def test_cycles_that_were_left_out_are_time_too():
    recorder = LinkRecorder()
    recorder.socket_error("the cable is out")
    recorder.command(0.0, None, overruns=NEWS)
    assert recorder.trouble == ""


def test_what_comes_again_is_told_again():
    recorder = LinkRecorder()
    for _ in range(2):
        recorder.socket_error("the cable is out")
        assert recorder.trouble == "the cable is out"
        cycles(recorder, NEWS)
        assert recorder.trouble == ""
