"""One step and one probe in lockstep on flat ground: base shift, swing, six forces, all feet down again."""

import numpy as np
import pytest
from test_standing import Script, run

from surefoot.bus.messages import LegStatus

LEG = 1  # front right
SHIFT, LIFT, LAND, PROBE = 0.4, 1.2, 2.0, 2.2
DWELL = 0.1
ASKED = np.array([60.0, 70.0, 80.0, 90.0, 100.0, 105.0])
END = PROBE + DWELL * len(ASKED)
STEP = np.array([0.10, 0.0, 0.0])


class StepAndProbe(Script):
    """A timed sequence in place of the state machine."""

    def extra(self, t):
        others = [leg for leg in range(4) if leg != LEG]
        goal = self.pose.copy()
        # Centre of mass 5 cm inside the triangle of the others, on the way to its centroid.
        corners = self.feet[others, :2]
        towards = corners.mean(axis=0) - self.pose[:2]
        goal[:2] += 0.055 * towards / np.hypot(*towards)
        feet = self.feet.copy()
        landed = self.feet[LEG] + STEP
        if t >= LAND:
            feet[LEG] = landed
        status = np.full(4, LegStatus.STANCE)
        if LIFT <= t < LAND:
            status[LEG] = LegStatus.SWING
        elif LAND <= t < END:
            status[LEG] = LegStatus.PROBING
        forces = np.zeros((len(ASKED) + 1, 3))
        forces[:, 2] = np.concatenate([[20.0], ASKED])
        return {
            "base_from": self.pose,
            "base_to": goal,
            "base_t0": SHIFT,
            "base_t1": LIFT - 0.1,
            "p_WF": feet,
            "leg_status": status,
            "swing_leg": LEG if t < LAND else -1,
            "swing_t0": LIFT,
            "swing_t1": LAND,
            "swing_from": self.feet[LEG],
            "swing_to": landed,
            "swing_height": 0.08,
            "swing_v_lift": 0.1,
            "swing_v_touch": 0.1,
            "support_leg": LEG,
            "support_t0": LIFT,
            "support_t1": END,
            "support_margin_m": 0.04,
            "probe_leg": LEG,
            "probe_t0": PROBE,
            "probe_dwell_s": DWELL,
            "probe_blend_s": 0.03,
            "probe_force_W": forces,
        }


@pytest.fixture(scope="module")
def log():
    return run(3.2, script=StepAndProbe)


def between(messages, start, end):
    return [message for message in messages if start <= message.t < end]


def test_the_foot_steps_ten_centimetres(log):
    before, after = between(log["sim/truth"], 0.5, 0.6)[0], log["sim/truth"][-1]
    moved = after.p_WF - before.p_WF
    np.testing.assert_allclose(moved[LEG], STEP, atol=0.02)
    assert np.abs(np.delete(moved, LEG, axis=0)).max() < 0.01
    assert max(truth.p_WF[LEG, 2] for truth in log["sim/truth"]) > 0.08
    assert after.body_contact == ""


def test_contact_is_lost_in_the_swing_and_found_after_it(log):
    swinging = between(log["state/estimate"], LIFT + 0.2, LAND - 0.2)
    assert not any(estimate.contact[LEG] for estimate in swinging)
    assert between(log["state/estimate"], LAND + 0.15, LAND + 0.16)[0].contact[LEG]


def test_the_probe_presses_with_the_asked_forces(log):
    held = []
    for index in range(len(ASKED)):
        start = PROBE + DWELL * index
        held.append(
            np.mean([truth.force_W[LEG, 2] for truth in between(log["sim/truth"], start + 0.05, start + 0.1)])
        )
    assert np.all(np.array(held) > 0.8 * ASKED)
    assert np.all(np.array(held) < ASKED + 10.0)


def test_the_centre_of_mass_stays_in_the_triangle(log):
    worst = 1.0
    for truth in between(log["sim/truth"], LIFT, END):
        # Anticlockwise triangle of the other feet: RR, FL, RL.
        corners = truth.p_WF[[3, 0, 2], :2]
        edges = np.roll(corners, -1, axis=0) - corners
        offset = truth.com_W[:2] - corners
        distance = (edges[:, 0] * offset[:, 1] - edges[:, 1] * offset[:, 0]) / np.hypot(edges[:, 0], edges[:, 1])
        worst = min(worst, distance.min())
    assert worst > 0.01


def test_the_robot_stays_level(log):
    assert min(abs(truth.quat_WB[0]) for truth in log["sim/truth"]) > np.cos(0.5 * 0.1)
