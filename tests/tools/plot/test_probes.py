"""What is said of a run's probes is what its state machine has told."""

import numpy as np
import pytest
import scenes

from surefoot.tools.plot.probes import choose, find_probes
from surefoot.tools.tables.recording_tables import load
from surefoot.tools.tables.table import NotRecorded


def probes(name):
    return find_probes(load(scenes.path(name)))


def test_a_probe_that_had_begun_before_the_recording_is_followed_to_its_end():
    (probe,) = probes("probe_holds")
    assert (probe.leg, probe.candidate, probe.verdict) == (2, 0, "accepted")
    (press,) = probe.presses
    assert press.around == 4 and press.end_t == pytest.approx(7.548)
    assert [round(event.asked_n) for event in press.held] == [67, 94, 99, 105, 108]
    assert probe.held_n == pytest.approx(110.0, abs=1.0) and probe.certified_n == pytest.approx(108.0, abs=1.0)
    assert "borne here and around" in probe.reason and np.isnan(probe.contact_t)


def test_a_collapse_ends_a_probe_and_the_next_candidate_is_another():
    first, second = probes("collapse")
    assert (first.leg, first.candidate, first.verdict) == (1, 0, "collapse")
    assert first.end_t == pytest.approx(23.18) and first.displacement_m == pytest.approx(0.0303, abs=1e-4)
    assert first.certified_n == 0.0 and "limit 3.0 cm" in first.reason
    assert (second.leg, second.candidate, second.verdict) == (1, 1, "unfinished")
    assert second.number == 2 and second.presses == []


def test_a_probe_begins_when_the_foot_lifts_off():
    (probe,) = probes("step")
    assert probe.begin_t == pytest.approx(2.04) and probe.contact_t == pytest.approx(2.608)
    assert [press.around for press in probe.presses] == [0] and probe.verdict == "unfinished"
    assert probe.presses[0].begin_t == pytest.approx(2.608) and probe.p_WF[1] > 0.1


def test_standing_up_is_no_probe():
    assert probes("stand") == [] and probes("map") == []


def test_a_probe_is_chosen_by_leg_and_number():
    found = probes("collapse")
    assert choose(found) == found and choose(found, leg=1, number=2) == [found[1]]
    with pytest.raises(NotRecorded, match="no probe of RL in this recording; there are probes of FR"):
        choose(found, leg=2)
    with pytest.raises(NotRecorded, match="no probe 3 of FR in this recording; there are 1 to 2: 1: FR at"):
        choose(found, leg=1, number=3)
    with pytest.raises(NotRecorded, match="there are none at all"):
        choose([], number=1)
