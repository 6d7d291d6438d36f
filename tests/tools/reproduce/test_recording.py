"""What the figures are drawn from is what was said on the bus at that instant."""

import numpy as np
import pytest

from surefoot.bus.messages import FsmEvent, JointCommand, MotionReference, Policy, SimTruth, StateEstimate
from surefoot.components.mpc.motion_sampler import MotionSampler
from surefoot.config.deployment import Deployment
from surefoot.tools.reproduce.recording.forces import FORCES, ForceSeries, asked_force
from surefoot.tools.reproduce.recording.instants import LEG_UP_AFTER_S, TICK_S, Instants, joint_positions

FEET = np.array([[0.25, 0.15, 0.0], [0.25, -0.15, 0.0], [-0.25, 0.15, 0.0], [-0.25, -0.15, 0.0]])


@pytest.fixture
def press():
    """Two forces, 100 ms each, from t = 1 s."""
    forces = np.array([[0.0, 0.0, 20.0], [5.0, -3.0, 60.0], [-4.0, 2.0, 100.0]])
    return MotionReference(
        state="PROBE",
        leg=1,
        probe_leg=1,
        probe_t0=1.0,
        probe_dwell_s=0.1,
        probe_blend_s=0.03,
        probe_force_W=forces,
        normal_W=np.array([0.0, 0.0, 1.0]),
    )


def truth(t=0.0, x=0.0, feet=FEET, com=(0.0, 0.0, 0.3), terrain=()):
    return SimTruth(
        t=t,
        p_WB=np.array([x, 0.0, 0.4]),
        quat_WB=np.array([1.0, 0.0, 0.0, 0.0]),
        q=np.arange(12.0),
        p_WF=np.array(feet),
        com_W=np.array(com),
        force_W=np.full((4, 3), 7.0),
        terrain_q=np.array(terrain),
    )


def test_the_force_asked_is_what_the_mpc_is_given(press):
    times = np.linspace(0.9, 1.25, 71)
    active, given = MotionSampler._probe(press, times, np.ones((len(times), 4), bool))
    mine = np.array([asked_force(press, t) for t in times])
    assert (np.isnan(mine).all(axis=1) == (active < 0)).all()
    np.testing.assert_allclose(mine[active >= 0], given[active >= 0])
    assert np.isnan(mine).any() and np.isfinite(mine).any()


def test_a_row_holds_the_forces_of_the_leg_that_probes(press):
    series = ForceSeries(Deployment())
    u = np.zeros((3, 24))
    u[1, 3:6] = [1.0, 2.0, 80.0]  # leg 1 in the second interval
    command, seen = np.zeros((4, 3)), np.zeros((4, 3))
    command[1], seen[1] = [1.5, 2.5, 81.0], [0.5, 1.5, 79.0]
    com = (0.02, -0.01, 0.3)
    for message in (
        truth(1.02, com=com),
        StateEstimate(force_W=seen),
        JointCommand(force_W=command),
        Policy(t=1.0, valid=True, dt=0.015, x=np.zeros((4, 24)), u=u, v=np.zeros((4, 18))),
        press,
    ):
        series("", message)
    (row,), kept = series.rows(), series.arrays()
    told = dict(zip([column.name for column in series.columns], row, strict=True))
    assert told["leg"] == 1 and told["pressing"] == 1 and told["t_s"] == 1.02
    share = 0.02 / 0.03
    assert told["asked_z_n"] == pytest.approx(20.0 + share * 40.0)
    expected = {"mpc": 80.0, "wbc": 81.0, "estimated": 79.0, "true": 7.0}
    assert {name: told[f"{name}_z_n"] for name in expected} == expected
    assert {name: kept[name].shape for name in FORCES} == dict.fromkeys(FORCES, (1, 3))
    # The triangle of the other feet: its edge from front left to hind right passes through the middle.
    edge = FEET[0, :2] - FEET[3, :2]
    inside = abs(edge[0] * com[1] - edge[1] * com[0]) / np.hypot(*edge)
    assert told["margin_m"] == pytest.approx(-inside) and kept["margin_m"][0] == pytest.approx(-inside)


def test_each_swing_begins_another_probe(press):
    series = ForceSeries(Deployment())
    for message in (
        truth(),
        StateEstimate(),
        JointCommand(),
        Policy(valid=True, dt=0.015, x=np.zeros((2, 24)), u=np.zeros((1, 24)), v=np.zeros((2, 18))),
    ):
        series("", message)
    for state in ("MOVE", "DETECT_CONTACT", "DETECT_CONTACT", "PROBE", "PROBE_AROUND", "PROBE", "LEG_UP"):
        series("", MotionReference(state=state, leg=1, normal_W=np.array([0.0, 0.0, 1.0])))
    assert series.arrays()["probe"].tolist() == [0, 0, 0, 1, 1]
    assert series.arrays()["pressing"].tolist() == [False, False, True, False, True]
    assert all(row[5] == "" for row in series.rows())  # no force is asked: empty in the CSV


def test_nothing_heard_is_an_empty_series():
    series = ForceSeries(Deployment())
    assert series.rows() == [] and len(series.arrays()["t"]) == 0
    assert series.arrays()["p_WF"].shape == (0, 4, 2)


def test_instants_are_kept_as_the_simulator_can_show_them():
    instants = Instants(Deployment())
    down = FEET.copy()
    down[1, 2] = -0.03
    instants("", truth(0.0, terrain=[0.1]))
    instants("", truth(1.0, x=0.2, feet=down, terrain=[0.4]))
    instants("", FsmEvent(kind="collapse", leg=1, candidate=2, displacement_m=0.031))
    instants("", FsmEvent(kind="transition", state="LEG_UP"))
    instants("", truth(1.0 + 0.5 * LEG_UP_AFTER_S, terrain=[0.3]))
    instants("", truth(1.0 + LEG_UP_AFTER_S, terrain=[0.2]))
    instants("", truth(TICK_S, x=0.5, terrain=[0.1]))
    kept = instants.arrays()
    assert kept["kind"].tolist() == ["tick", "collapse", "leg_up", "tick", "end"]
    np.testing.assert_allclose(kept["t"], [0.0, 1.0, 1.0 + LEG_UP_AFTER_S, TICK_S, TICK_S])
    np.testing.assert_array_equal(kept["foot_W"][1], down[1])
    np.testing.assert_array_equal(kept["qpos"][1], joint_positions(truth(1.0, x=0.2, terrain=[0.4])))
    assert kept["qpos"].shape == (5, 20) and kept["leg"].tolist() == [-1, 1, 1, -1, -1]
    assert len(instants.rows()) == 5  # the end is there once, however often it is asked for
