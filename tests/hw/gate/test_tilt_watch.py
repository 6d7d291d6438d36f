"""The gate's own attitude: right through a turn, and neither a push nor a bias of the gyroscope moves it far."""

from math import cos, nan, sin

import numpy as np
import pytest

from surefoot.hw.gate.tilt_watch import TiltWatch

G = 9.81
DT = 0.002
UP = np.array([0.0, 0.0, G])
REST = np.zeros(3)


def force(roll, pitch):
    """Specific force at rest, of a trunk turned about y, then about its own x."""
    return G * np.array([-sin(pitch), sin(roll) * cos(pitch), cos(roll) * cos(pitch)])


@pytest.fixture
def watch():
    return TiltWatch(1.0, 0.5)


def follow(watch, seconds, omega, acc):
    """Cycles of `omega(t)` and `acc(t)`, from t = 0; the tilt at the end."""
    for n in range(round(seconds / DT) + 1):
        watch.violation(omega(n * DT), acc(n * DT), n * DT)
    return watch.tilt


@pytest.mark.parametrize(("roll", "pitch"), [(0.0, 0.0), (0.3, 0.0), (0.0, -0.4), (0.5, 0.5), (2.9, 0.1)])
def test_a_robot_at_rest_is_as_tilted_as_it_says_at_once(watch, roll, pitch):
    watch.violation(REST, force(roll, pitch), 0.0)
    assert watch.tilt == pytest.approx(np.arccos(cos(roll) * cos(pitch)))


@pytest.mark.parametrize("axis", [0, 1])
@pytest.mark.parametrize("way", [-1.0, 1.0])
def test_a_turn_is_followed_by_the_gyroscope_alone(watch, axis, way):
    """Weightless: the accelerometer says nothing."""
    omega = way * 2.0 * np.eye(3)[axis]
    watch.violation(REST, UP, 0.0)
    assert follow(watch, 0.8, lambda t: omega, lambda t: REST if t else UP) == pytest.approx(1.6, abs=2e-3)


def test_a_turn_about_an_axis_of_which_all_three_parts_are_there_is_followed(watch):
    """A trunk with up at (sin 0.5, 0, cos 0.5) turns about up itself, and stays as tilted as it is."""
    up = np.array([sin(0.5), 0.0, cos(0.5)])
    assert follow(watch, 2.0, lambda t: 3.0 * up, lambda t: G * up) == pytest.approx(0.5, abs=1e-3)


def test_a_roll_that_gyroscope_and_accelerometer_both_see_is_followed(watch):
    omega = np.array([1.5, 0.0, 0.0])
    assert follow(watch, 0.6, lambda t: omega, lambda t: force(1.5 * t, 0.0)) == pytest.approx(0.9, abs=2e-3)


@pytest.mark.parametrize(("push", "lasts", "most"), [(20.0, 2.0, 1e-9), (5.0, 0.2, 0.08), (2.0, 5.0, 0.21)])
def test_an_acceleration_along_the_ground_is_hardly_taken_for_a_tilt(watch, push, lasts, most):
    watch.violation(REST, UP, 0.0)
    assert follow(watch, lasts, lambda t: REST, lambda t: UP + (push if t else 0.0) * np.eye(3)[0]) <= most


def test_a_bias_of_the_gyroscope_is_worth_its_time_constant(watch):
    bias = np.array([0.02, 0.0, 0.0])
    assert follow(watch, 20.0, lambda t: bias, lambda t: UP) == pytest.approx(0.02 * 0.5, rel=0.02)


def test_what_it_was_wrong_about_it_forgets_with_its_time_constant(watch):
    watch.violation(REST, force(0.5, 0.0), 0.0)
    assert follow(watch, 0.5, lambda t: REST, lambda t: UP if t else force(0.5, 0.0)) == pytest.approx(
        0.5 * np.exp(-1.0), rel=0.05
    )


def test_after_a_gap_it_begins_anew(watch):
    watch.violation(REST, UP, 0.0)
    watch.violation(np.array([30.0, 0.0, 0.0]), force(0.0, 1.2), 0.11)
    assert watch.tilt == pytest.approx(1.2)


def test_which_way_is_up_is_not_known_before_there_is_weight(watch):
    assert watch.violation(REST, REST, nan) is None and np.isnan(watch.tilt)
    watch.violation(REST, UP, 0.002)
    assert watch.tilt == 0.0
