"""Where the press test's verdict hangs on millimetres it says so."""

from dataclasses import replace

import numpy as np

from surefoot.config.deployment import Deployment
from surefoot.config.terrain import Terrain
from surefoot.tools.evaluation.labels import NEAR_M, Labels

FORCE_N = 110.0


def test_a_point_is_in_doubt_where_the_verdict_changes_close_by():
    deployment = replace(Deployment(), terrain=Terrain(kind="planks"))
    labels = Labels(deployment)
    y = 0.5 * deployment.terrain.planks.board_width_m
    xs = np.arange(0.30, 0.60, 0.01)
    verdicts = [labels.fails(np.array([x, y]), FORCE_N) for x in xs]
    gives = xs[verdicts.index(False) + verdicts[verdicts.index(False) :].index(True)]  # along one board
    low, high = gives - 0.01, gives
    while high - low > 0.001:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if labels.fails(np.array([middle, y]), FORCE_N) else (middle, high)
    for x, doubt in ((low, True), (high, True), (high + NEAR_M + 0.02, False)):
        assert labels.in_doubt(np.array([x, y]), FORCE_N) is doubt
    at = np.array([high + NEAR_M + 0.02, y])
    assert labels.fails(at, FORCE_N) and not labels.fails(at, 20.0)
