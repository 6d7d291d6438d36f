"""The measures of many runs together."""

from __future__ import annotations

from typing import Any

import numpy as np

from surefoot.tools.evaluation.grader import ENVELOPE_FORCES

Run = dict[str, Any]
"""One entry of `runs` in `results.json`."""


def is_error(run: Run) -> bool:
    """The program failed, not the robot: the run has to be done again."""
    return str(run["failure"]).startswith("error:")


class Pooled:
    """What the runs of one `results.json` measured between them.

    Attributes:
        runs: all of them.
        whole: those with measures; a run that ended with an error of the program has none.
    """

    def __init__(self, runs: list[Run]):
        self.runs = runs
        self.whole = [run for run in runs if "footholds" in run]

    def total(self, count: str) -> int:
        """Sum of a count."""
        return sum(run[count] for run in self.whole)

    def all(self, key: str) -> np.ndarray:
        """(n,) the entries of a list, one run after the other."""
        return np.array([value for run in self.whole for value in run.get(key, ())], float)

    def each(self, *keys: str) -> np.ndarray:
        """(n,) one figure of each run, found by its keys from the outside in; without the runs that have none."""
        found = []
        for run in self.whole:
            value: Any = run
            for key in keys:
                value = value.get(key) if value is not None else None
            if value is not None:
                found.append(value)
        return np.array(found, float)

    @property
    def succeeded(self) -> int:
        """How many runs were a success."""
        return sum(bool(run["success"]) for run in self.runs)

    def failed_with(self, *failures: str) -> int:
        """How many runs failed in one of these ways."""
        return sum(run["failure"] in failures for run in self.runs)

    @property
    def precision(self) -> float | None:
        """Share of the collapses called that the press test bears out."""
        wrong = self.total("false_alarms")
        right = self.total("true_positives") + self.total("late_collapses") - self.total("late_false_alarms")
        return right / (right + wrong) if right + wrong else None

    @property
    def recall(self) -> float | None:
        """Share of the probed points that fail the press test whose collapse was called."""
        found, lost = self.total("true_positives"), self.total("false_negatives")
        return found / (found + lost) if found + lost else None

    @property
    def peak_shares(self) -> np.ndarray:
        """(n,) true over asked normal force at the envelope's peak, of the probes that were held to their end."""
        forces = [run["probe_force"] for run in self.whole]
        if not forces:
            return np.zeros(0)
        index, asked, true = (
            np.concatenate([f[key] for f in forces]) for key in ("force_index", "asked_n", "true_n")
        )
        # Forces come by rising normal force.
        last = index == ENVELOPE_FORCES - 1
        return true[last] / np.maximum(asked[last], 1.0)
