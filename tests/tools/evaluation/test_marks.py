"""Each mark on runs that just reach it and on runs that just miss it."""

from dataclasses import replace

import pytest
from made_runs import ERROR, failed, forces, of_kind, results, run

from surefoot.config.deployment import Deployment
from surefoot.tools.evaluation.arms import ARMS
from surefoot.tools.evaluation.marks import MARKS, judge

STRIDE = replace(Deployment(), fsm=replace(Deployment().fsm, base_reference="stride"))


def row(name, *runs, asked="", **head):
    """The one row of a name (and of a mark asked, where there are two)."""
    found = [each for each in judge(results(*runs, **head)) if each.mark.startswith(name) and asked in each.asked]
    assert len(found) == 1, found
    return found[0]


def met(name, *runs, **head):
    return row(name, *runs, **head).met


def many(good, *others):
    return [run(seed) for seed in range(good)] + list(others)


@pytest.mark.parametrize("scenario", ["planks", "planks_missing", "rocks"])
def test_nine_of_ten_have_to_cross_and_none_may_fall(scenario):
    assert met("success", *many(9, failed("stuck")), scenario=scenario) is True
    assert met("success", *many(8, failed("stuck"), failed("timeout")), scenario=scenario) is False
    assert met("success", *many(99, failed("fell")), scenario=scenario) is False
    assert row("success", *many(9, failed("fell")), scenario=scenario).got == "9 of 10, 1 fell"


def test_an_error_of_the_program_is_no_crossing_and_no_failure_of_the_baseline():
    assert met("success", *many(4, ERROR)) is False
    baseline = {"arm": "mpc_only"}
    falls = [failed("fell", seed) for seed in range(8)]
    assert met("baseline", *falls, run(), run(), **baseline) is True
    assert met("baseline", *falls[1:], run(), run(), **baseline) is False
    assert met("baseline", *falls[1:], run(), run(), ERROR, **baseline) is False
    assert met("baseline", ERROR, **baseline) is None


def test_the_time_is_the_mean_of_those_that_crossed():
    assert met("mean", run(0, sim_time_s=389.0), run(1, sim_time_s=390.0)) is True
    assert met("mean", run(0, sim_time_s=390.0)) is False
    assert row("mean", run(0, sim_time_s=200.0), failed("timeout", 1, sim_time_s=1200.0)).got == "200 s"
    assert met("mean", failed("fell", sim_time_s=10.0)) is None


def test_missed_collapses_are_a_share_of_all_accepted_footholds_on_any_ground():
    for scenario in ("planks", "tiles", "slope"):
        head = {"scenario": scenario}
        assert met("missed", run(0, footholds=60, missed_collapses=2), run(1, footholds=40), **head) is True
        assert met("missed", run(0, footholds=60, missed_collapses=3), run(1, footholds=40), **head) is False


def test_detection_on_tiles_is_of_all_runs_together():
    good = run(0, true_positives=95, false_negatives=5, false_alarms=10)
    assert met("recall", good, scenario="tiles") is True
    assert met("precision", good, scenario="tiles") is True
    # A run that on its own would be bad does not count for more than its probes.
    assert met("recall", good, run(1, true_positives=0, false_negatives=1), scenario="tiles") is False
    assert row("recall", good, scenario="tiles").got == "0.950"
    late = run(0, true_positives=8, late_collapses=3, late_false_alarms=1, false_alarms=2)
    assert row("precision", late, scenario="tiles").got == "0.833"
    none = run(0, true_positives=0, false_negatives=0, false_alarms=0)
    assert met("recall", none, scenario="tiles") is None and met("precision", none, scenario="tiles") is None


@pytest.mark.parametrize(("scenario", "most"), [("flat", 2), ("foam", 10)])
def test_false_alarms_are_a_share_of_the_probes(scenario, most):
    assert met("false", run(0, probes=100, false_alarms=most), scenario=scenario) is True
    assert met("false", run(0, probes=100, false_alarms=most + 1), scenario=scenario) is False
    assert met("false", run(0, probes=0), scenario=scenario) is None


def test_displacement_has_a_median_and_a_tail():
    assert met("displacement", run(0, displacement_at_detection_m=[0.031, 0.033, 0.034])) is True
    assert met("displacement", run(0, displacement_at_detection_m=[0.031, 0.0335, 0.034])) is False
    assert met("displacement", run(0, displacement_at_detection_m=[0.031] * 9 + [0.06])) is False


def test_every_foot_has_to_be_unloaded_in_time():
    assert met("unloaded", run(0, unload_s=[0.02, 0.149])) is True
    assert met("unloaded", run(0, unload_s=[0.02]), run(1, unload_s=[0.151])) is False


def test_the_worst_run_counts_for_the_forces_of_fig_10():
    held = {"probe_force": forces([98.0]), "scenario": "flat"}
    scenario = held.pop("scenario")

    def rmse(mpc, estimate):
        return {"probe_rmse_n": {"true_vs_mpc": mpc, "estimate_vs_true": estimate}} | held

    runs = run(0, **rmse(9.9, 7.9)), run(1, **rmse(1.0, 1.0))
    assert met("Fig. 10: true", *runs, scenario=scenario) is True
    assert met("Fig. 10: estimate", *runs, scenario=scenario) is True
    runs = run(0, **rmse(10.1, 8.1)), run(1, **rmse(1.0, 1.0))
    assert met("Fig. 10: true", *runs, scenario=scenario) is False
    assert met("Fig. 10: estimate", *runs, scenario=scenario) is False
    # Without a force held there is no error to boast of.
    assert met("Fig. 10: true", run(0), scenario=scenario) is None


def test_fig_9_is_judged_with_the_strides_reference_alone():
    assert not any(
        "Fig. 9" in each.mark for each in judge(results(run(0), scenario="flat", deployment=Deployment()))
    )
    head = {"scenario": "flat", "deployment": STRIDE}
    assert (
        met("Fig. 9: CoM", run(0, min_support_margin_m=0.010), run(1, min_support_margin_m=0.05), **head) is True
    )
    assert (
        met("Fig. 9: CoM", run(0, min_support_margin_m=0.009), run(1, min_support_margin_m=0.05), **head) is False
    )
    assert met("Fig. 9: true force", run(0, probe_force=forces([99.0, 80.0])), **head) is True
    assert met("Fig. 9: true force", run(0, probe_force=forces([99.0, 79.0])), **head) is False
    head["arm"] = "no_support_polygon"
    assert met("Fig. 9: without", run(0, min_support_margin_m=0.01), run(1, min_support_margin_m=-0.001), **head)
    assert met("Fig. 9: without", run(0, min_support_margin_m=0.001), **head) is False


def test_no_foothold_may_be_accepted_at_the_drop_and_without_probing_around_some_are():
    far, near, over = [0.025, 0.1], [0.1, 0.024], [-0.003]
    edge = {"scenario": "edge"}
    assert met("accepted", run(0, edge_distance_m=far), **edge) is True
    for bad in (near, over):
        assert met("accepted", run(0, edge_distance_m=far), run(1, edge_distance_m=bad), **edge) is False
        assert met("accepted", run(0, edge_distance_m=bad), arm="no_probe_around", **edge) is True
    assert met("accepted", run(0, edge_distance_m=far), arm="no_probe_around", **edge) is False
    assert met("accepted", run(0), **edge) is None
    assert row("accepted", run(0, edge_distance_m=near), **edge).got == "1 of 2, nearest 2.4 cm"


def test_a_trap_has_to_stop_it_every_time():
    assert met("stops", *many(10), scenario="trap") is True
    assert met("stops", *many(9, failed("crossed")), scenario="trap") is False


def test_marks_go_by_the_terrain_whatever_the_file_is_called():
    head = results(run(0), scenario="mine") | {"config": of_kind("trap")}
    assert [each.mark for each in judge(head)] == ["stops", "missed collapses"]


def test_planks_with_boards_missing_are_not_asked_for_the_planks_time():
    head = results(run(0), scenario="planks_missing") | {"config": of_kind("planks")}
    assert [each.mark for each in judge(head)] == ["success", "missed collapses"]


def test_a_general_mark_without_anything_to_judge_is_left_out():
    marks = {each.mark for each in judge(results(run(0), scenario="slope"))}
    assert marks == {"missed collapses"}


def test_other_arms_are_not_asked_for_what_the_full_one_is():
    for arm in ("no_probe_around", "true_state", "threshold=0.02", "fixed_force=80"):
        assert judge(results(run(0), arm=arm)) == []


def test_the_table_speaks_of_arms_that_there_are():
    assert {arm for mark in MARKS for arm in mark.arms} <= set(ARMS)


def test_no_runs_meet_no_mark():
    assert not any(each.met for each in judge(results()))
