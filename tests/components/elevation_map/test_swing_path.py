"""Many swings at once are the swing splines one by one."""

import numpy as np

from surefoot.bus.messages import MotionReference
from surefoot.components.elevation_map.swing_path import SwingPath
from surefoot.components.gait.swing_spline import SwingSpline
from surefoot.config.fsm import Fsm


def test_the_points_lie_on_the_swing_spline_of_each_end():
    settings = Fsm(swing_s=0.7, swing_height_m=0.06, swing_v_lift=0.2, swing_v_touch=0.15)
    path, rng = SwingPath(settings), np.random.default_rng(0)
    for _ in range(10):
        normal = rng.normal([0.0, 0.0, 1.0], 0.2)
        normal /= np.linalg.norm(normal)
        start, ends = rng.normal(size=3), rng.normal(size=(6, 3))
        points = path.points(start, ends, normal)
        times = 0.7 * np.arange(1, points.shape[1] + 1) / (points.shape[1] + 1)
        for end, found in zip(ends, points, strict=True):
            spline = SwingSpline(
                MotionReference(
                    swing_t1=0.7,
                    swing_from=start,
                    swing_to=end,
                    swing_height=0.06,
                    swing_v_lift=0.2,
                    swing_v_touch=0.15,
                    normal_W=normal,
                )
            )
            np.testing.assert_allclose(found, spline.sample(times)[0], atol=1e-12)
