"""Each term's derivatives, and what the whole problem does with a standing and a probing robot."""

from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest
from standing import LEGS, ROBOT, WEIGHT, standing

from surefoot.components.ocp.layout import JOINTS, MOMENTUM, POSITION, ROTATION
from surefoot.components.ocp.problem import Problem
from surefoot.components.ocp.quadratic_model import QuadraticModel
from surefoot.components.ocp.riccati import StageQP
from surefoot.components.ocp.term import Nodes
from surefoot.components.robot_model.rotations import exp_rotations
from surefoot.config.ocp import Barrier, Ocp

N = 5
STEP = 1e-6  # of central differences
TOLERANCE = 1e-7  # they leave 5e-9 of the largest slope


def busy_nodes():
    """A problem in which every term is active: one leg swings, one probes, all deviate from the reference."""
    rng = np.random.default_rng(0)
    reference, _ = standing(N)
    reference.R_WB[:] = pin.exp3(np.array([0.15, -0.10, 0.3]))
    reference.contact[2:, 1] = False
    reference.support_leg[:] = 2
    reference.probe_leg[:] = 2
    reference.probe_force_W[:] = [3.0, -2.0, 90.0]
    reference.region_active[:] = True
    reference.force_max_n[:] = [np.inf, 70.0, 58.0, 90.0]  # leg 2 is over its cap, the others are not
    reference.region_a[:] = rng.normal(size=(4, 4, 3))
    reference.region_b[:] = 0.02 - (reference.region_a @ reference.p_WF[0][..., None])[..., 0]
    problem = Problem(Ocp(), ROBOT, N)
    iterate = problem.cold_start(reference)
    iterate.h += 0.05 * rng.normal(size=iterate.h.shape)
    iterate.p_WB += 0.01 * rng.normal(size=iterate.p_WB.shape)
    iterate.R_WB = iterate.R_WB @ exp_rotations(0.05 * rng.normal(size=(N + 1, 3)))
    iterate.q += 0.03 * rng.normal(size=iterate.q.shape)
    stance = reference.contact[:N, :, None]
    iterate.force_W += 5.0 * rng.normal(size=iterate.force_W.shape) * stance
    iterate.foot_velocity_W += 0.1 * rng.normal(size=iterate.foot_velocity_W.shape) * ~stance
    linear = problem.linearise(iterate, reference).linear
    iterate.v = iterate.v + linear.v_c
    return problem, problem.linearise(iterate, reference)


PROBLEM, NODES = busy_nodes()
# A linearisation holds until the next one of the same problem: displaced nodes need their own.
OTHER = Problem(Ocp(), ROBOT, N)


def moved(nodes, node, delta):
    """The nodes with node `node` displaced by delta (36,) in (u, x)."""
    old, linear = nodes.iterate, nodes.linear
    du, dx = delta[:12], delta[12:]
    stance = nodes.reference.contact[node, :, None]
    new = replace(
        old,
        h=old.h.copy(),
        p_WB=old.p_WB.copy(),
        R_WB=old.R_WB.copy(),
        q=old.q.copy(),
        force_W=old.force_W.copy(),
        foot_velocity_W=old.foot_velocity_W.copy(),
        v=old.v.copy(),
    )
    new.h[node] += dx[MOMENTUM]
    new.p_WB[node] += dx[POSITION]
    new.R_WB[node] = old.R_WB[node] @ exp_rotations(dx[None, ROTATION])[0]
    new.q[node] += dx[JOINTS].reshape(4, 3)
    new.force_W[node] += du.reshape(4, 3) * stance
    new.foot_velocity_W[node] += du.reshape(4, 3) * ~stance
    new.v[node] += linear.v_x[node] @ dx + linear.v_u[node] @ du
    return Nodes(new, OTHER.linearise(new, nodes.reference).linear, nodes.reference)


@pytest.mark.parametrize("term", (PROBLEM.tracking, *PROBLEM.constraints), ids=lambda term: term.name)
def test_gradients_are_those_of_the_value(term):
    qp = StageQP(N, 24, 12)
    model = QuadraticModel(qp)
    term.add(NODES, model)
    model.write(NODES.linear)
    H, g = qp.H, qp.g
    assert np.abs(g).max() > 0.0
    np.testing.assert_allclose(H, H.swapaxes(1, 2), atol=1e-6 * np.abs(H).max())
    assert np.linalg.eigvalsh(H).min() > -1e-7 * np.abs(H).max()
    for node in (0, 3):
        slope = np.empty(36)
        for i in range(36):
            delta = STEP * np.eye(36)[i]
            up, down = term.value(moved(NODES, node, delta)), term.value(moved(NODES, node, -delta))
            slope[i] = (up[node] - down[node]) / (2 * STEP)
        if term.name == "tracking":
            slope[12:][ROTATION] -= turning_left_out(node)
        np.testing.assert_allclose(g[node], slope, atol=TOLERANCE * max(1.0, np.abs(slope).max()))


def test_a_cap_acts_on_its_own_foot_only():
    limits = next(term for term in PROBLEM.constraints if term.name == "certified_load")

    def slope(caps):
        reference = replace(NODES.reference, force_max_n=np.tile(caps, (N + 1, 1)))
        model = QuadraticModel(StageQP(N, 24, 12))
        limits.add(Nodes(NODES.iterate, NODES.linear, reference), model)
        return model.u_slope

    change = slope([np.inf, np.inf, 40.0, np.inf]) - slope([np.inf] * 4)
    assert (change[:, 2, 2] > 0.5).all() and not change[:, [0, 1, 3]].any()
    # A foothold that bears more than the robot may press changes nothing.
    np.testing.assert_array_equal(slope([500.0] * 4), slope([np.inf] * 4))


def turning_left_out(node):
    """(J' - 1) Q e: by design the tracking cost takes the Jacobian J of its rotation error e as one."""
    error = NODES.reference.R_WB[node].T @ NODES.iterate.R_WB[node]
    weighted = PROBLEM.tracking.Q[ROTATION] * pin.log3(error)
    return (pin.Jlog3(error).T - np.eye(3)) @ weighted


def test_a_standing_robot_carries_a_quarter_of_its_weight_on_each_foot():
    reference, measured = standing()
    step, iterations = Problem(Ocp(), ROBOT, 67).converge(reference, measured, 10, 1e-5)
    force = step.iterate.force_W
    # The cones' barriers push forces up, and towards the horizon's end little holds the base down.
    np.testing.assert_allclose(force.sum(axis=1)[20:40, 2], WEIGHT, rtol=1e-2)
    # The centre of mass is millimetres off the middle of the feet.
    np.testing.assert_allclose(force[20:40, :, 2], WEIGHT / 4, atol=4.0)
    assert iterations < 10
    assert np.abs(step.iterate.p_WB[:40] - measured.p_WB).max() < 1e-3


def shifted_into_triangle(leg):
    """Standing with the base reference inside the triangle of the other three feet."""
    reference, measured = standing()
    others = [i for i in range(4) if i != leg]
    away = reference.p_WF[0, others, :2].mean(axis=0) * 0.9
    reference.p_WB[:, :2] += away
    reference.q[:] = LEGS.inverse(reference.p_WF - reference.p_WB[:, None])[0]
    return reference, replace(measured, p_WB=reference.p_WB[0].copy(), q=reference.q[0].copy())


def on_three_feet():
    """Standing with the front right leg in the air, the base inside the triangle of the others."""
    reference, measured = shifted_into_triangle(1)
    reference.contact[:, 1] = False
    reference.force_W = reference.contact[..., None] * [0.0, 0.0, WEIGHT / 3]
    return reference, measured


def test_a_foot_is_asked_for_little_more_than_its_foothold_is_certified_for():
    reference, measured = on_three_feet()
    problem = Problem(Ocp(), ROBOT, 67)
    free, _ = problem.converge(reference, measured, 15, 1e-4)
    loaded = int(free.iterate.force_W[10, :, 2].argmax())
    cap = free.iterate.force_W[10, loaded, 2] - 8.0
    reference.force_max_n[:, loaded] = cap
    held, _ = problem.converge(reference, measured, 15, 1e-4)
    # Only a base that moves takes a load off: it gives way and comes to rest.
    assert held.iterate.force_W[20:40, loaded, 2].max() < cap + 6.0
    moved = np.linalg.norm(held.iterate.p_WB - measured.p_WB, axis=1)
    assert 0.002 < moved[:40].max() < 0.03


@pytest.mark.parametrize("feet", [4, 3])
def test_feet_carry_the_robot_whatever_they_are_certified_for(feet):
    reference, measured = standing() if feet == 4 else on_three_feet()
    reference.force_max_n[:] = 60.0
    step, _ = Problem(Ocp(), ROBOT, 67).converge(reference, measured, 15, 1e-4)
    np.testing.assert_allclose(step.iterate.force_W[10:40].sum(axis=1)[:, 2], WEIGHT, rtol=0.04)
    assert np.abs(step.iterate.p_WB - measured.p_WB)[:40].max() < 0.01


@pytest.mark.parametrize("leg", range(4))
def test_probing_falls_short_of_the_asked_force_and_keeps_inside_the_polygon(leg):
    reference, measured = shifted_into_triangle(leg)
    asked = 115.0
    reference.support_leg[:] = leg
    reference.probe_leg[20:] = leg
    reference.probe_force_W[20:] = [0.0, 0.0, asked]
    problem = Problem(Ocp(), ROBOT, 67)
    step, _ = problem.converge(reference, measured, 15, 1e-4)
    nodes = problem.linearise(step.iterate, reference)
    held = step.iterate.force_W[25:, leg, 2]
    assert 0.80 * asked < held.mean() < asked
    assert problem.violations(nodes)["support_polygon"] < reference.support_margin_m - 0.01


def test_without_the_polygon_the_force_is_tracked_closer():
    reference, measured = standing()
    reference.probe_leg[20:40] = 0
    reference.probe_force_W[20:40] = [0.0, 0.0, 110.0]
    free, _ = Problem(Ocp(), ROBOT, 67).converge(reference, measured, 15, 1e-4)
    reference.support_leg[:] = 0
    tight = Ocp(support_polygon=Barrier(100.0, 0.02))
    held, _ = Problem(tight, ROBOT, 67).converge(reference, measured, 15, 1e-4)
    errors = [110.0 - step.iterate.force_W[22:38, 0, 2].mean() for step in (free, held)]
    assert abs(errors[0]) < errors[1]
