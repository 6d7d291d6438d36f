"""Hand-made entries of `results.json`."""

from surefoot.config.deployment import Deployment
from surefoot.config.typed_toml import to_table

ERROR = {"seed": 9, "success": False, "failure": "error: worker died (exit code -9)"}


def forces(peaks=(), asked=100.0):
    """`probe_force` of probes held to their end, with these true forces at the peak."""
    figures = {"force_index": [5] * len(peaks), "asked_n": [asked] * len(peaks), "true_n": list(peaks)}
    return {"mpc_n": [], "wbc_n": [], "estimated_n": []} | figures


def run(seed=0, **figures):
    """A whole run; what is not given is dull."""
    dull = {
        "seed": seed, "success": True, "failure": None, "sim_time_s": 100.0, "real_time_factor": 0.8,
        "footholds": 10, "probes": 50, "candidates_per_foothold": 1.5, "collapses_detected": 4,
        "missed_collapses": 0, "late_collapses": 0, "late_false_alarms": 0, "false_alarms": 0,
        "true_positives": 4, "false_negatives": 0, "in_hole": 0, "rejected_by_map": 0,
        "doubtful_alarms": 0, "doubtful_misses": 0,
        "min_support_margin_m": 0.041, "max_tilt_rad": 0.1, "displacement_at_detection_m": [], "unload_s": [],
        "edge_distance_m": [], "probe_force": forces(),
        "probe_rmse_n": {"true_vs_mpc": 1.26, "estimate_vs_true": 2.14},
        "estimator": {"xy_drift_per_m": 0.0042, "z_error_max_m": 0.013, "tilt_error_max_rad": 0.01},
        "timing_ms": {"physics": {"p50": 0.09, "p99": 0.15, "max": 8.1}},
    }  # fmt: skip
    return dull | figures


def failed(failure, seed=0, **figures):
    """A whole run that failed."""
    return run(seed, success=False, failure=failure, **figures)


def results(*runs, scenario="planks", arm="full", deployment=None):
    """A `results.json`."""
    config = {} if deployment is None else to_table(deployment)
    return {"scenario": scenario, "arm": arm, "config": config, "runs": list(runs)}


def of_kind(kind):
    """A `config` whose terrain is of this kind, whatever the deployment's file is called."""
    table = to_table(Deployment())
    return table | {"terrain": table["terrain"] | {"kind": kind}}
