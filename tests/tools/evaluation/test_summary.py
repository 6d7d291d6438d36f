"""What is to be read of a results file is what stands in it."""

from made_runs import ERROR, failed, forces, results, run

from surefoot.tools.evaluation.summary import summary


def summed(*runs, **head):
    return summary(results(*runs) | head)


def test_the_summary_counts_runs_footholds_and_probes():
    text = summed(
        run(0, missed_collapses=1, late_collapses=2, false_alarms=3, in_hole=6, rejected_by_map=7),
        failed(
            "fell", 1, missed_collapses=2, min_support_margin_m=None, candidates_per_foothold=None, sim_time_s=14.4
        ),
        ERROR,
    )
    assert "| 0 | success | 100 | 10 | 1.5 | 4 | 1 | 2 | 3 | 6 | 7 | 41 | 0.10 | 0.80 |" in text
    assert "| 1 | fell | 14 | 10 | - | 4 | 2 | 0 | 0 | 0 | 0 | - | 0.10 | 0.80 |" in text
    assert "| 9 | error: worker died (exit code -9) |" in text
    assert "- success 1 of 3\n" in text
    assert "- missed collapses 3 of 20 accepted footholds\n" in text
    assert "- false alarms 3 of 100 probes\n" in text
    table = text[: text.index("\n\n- success")].splitlines()
    assert len({line.count("|") for line in table if line.startswith("|")}) == 1


def test_a_failure_with_a_bar_in_its_words_does_not_break_the_table():
    text = summed(run(0), {"seed": 1, "success": False, "failure": "error: TypeError: int | None (x.py:1)"})
    assert "| 1 | error: TypeError: int / None (x.py:1) |" in text


def test_the_summary_lists_what_each_run_measured():
    still = {"xy_drift_per_m": None, "z_error_max_m": 0.0, "tilt_error_max_rad": 0.02}
    text = summed(run(0), run(1, estimator=still, probe_rmse_n={"true_vs_mpc": 9.0, "estimate_vs_true": 7.0}))
    assert "- true against MPC's force, RMSE N: 1.3, 9.0\n" in text
    assert "- estimate against truth, RMSE N: 2.1, 7.0\n" in text
    assert "- drift of x, y per metre: 0.004\n" in text
    assert "- largest error of height, cm: 1.3, 0.0\n" in text
    assert "- largest tilt error, degrees: 0.6, 1.1\n" in text
    assert "- displacement" not in text and "- unloaded" not in text and "peak" not in text and "drop" not in text


def test_displacement_and_unloading_are_over_all_collapses():
    text = summed(
        run(0, displacement_at_detection_m=[0.030, 0.031], unload_s=[0.02, 0.03]),
        run(1, displacement_at_detection_m=[0.040], unload_s=[0.13]),
    )
    # Between order statistics numpy interpolates: 95 % of three is 3.1 + 0.9 * 0.9.
    assert "- displacement at detection, cm: median 3.1, p95 3.9\n" in text
    assert "- unloaded after detection, ms: median 30, max 130\n" in text


def test_peaks_are_those_of_the_last_force_whatever_comes_before_and_after():
    # A probe that breaks off at 70 N, one to 90 N, one that begins higher than the last ended, and the next run.
    first = {
        "force_index": [3, 4, 0, 4, 5, 0, 5],
        "asked_n": [60.0, 70.0, 40.0, 80.0, 90.0, 95.0, 100.0],
        "true_n": [10.0, 10.0, 10.0, 10.0, 81.0, 10.0, 98.0],
    }
    text = summed(run(0, probe_force=first), run(1, probe_force=forces([200.0], asked=200.0)))
    assert "- true force over the envelope's peak: median 0.98, least 0.90 of 3 probes\n" in text


def test_distances_to_the_drop_are_listed_from_the_nearest_on():
    text = summed(run(0, edge_distance_m=[0.05, 0.031]), run(1, edge_distance_m=[-0.004]))
    assert "- accepted footholds beside the drop, cm from it: -0.4, 3.1, 5.0\n" in text


def test_times_are_the_middle_run_and_the_worst_step():
    slow = {"physics": {"p50": 0.19, "p99": 0.3, "max": 4.0}}
    text = summed(run(0), run(1, timing_ms=slow), run(2))
    assert "- physics, wall ms a step: p50 0.09, p99 0.30, max 8.1\n" in text


def test_the_head_says_how_it_saw():
    assert summed(run(0), vision=True).startswith("# planks, arm full, with vision\n")
    assert summed(run(0), vision=False).startswith("# planks, arm full, blind\n")


def test_the_marks_stand_below_the_measures():
    text = summed(run(0, sim_time_s=400.0))
    assert "| mark | asked | got | met |" in text
    assert "| mean simulated time | < 390 s | 400 s | NO |" in text
    assert "| success | ≥ 9 of 10, no fall | 1 of 1, 0 fell | yes |" in text


def test_nothing_but_errors_is_summed_up_too():
    text = summed(ERROR)
    assert "worker died" in text and "- success" not in text and "| mark |" not in text
