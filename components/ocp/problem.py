"""The optimal control problem composed from its named terms, and one SQP iteration on it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from surefoot.components.ocp.centroidal_dynamics import CentroidalDynamics, Trajectory
from surefoot.components.ocp.certified_load import CertifiedLoad
from surefoot.components.ocp.foot_placement import FootPlacement
from surefoot.components.ocp.force_limits import ForceLimits
from surefoot.components.ocp.friction_cone import FrictionCone
from surefoot.components.ocp.joint_limits import JointPositionLimits, JointVelocityLimits
from surefoot.components.ocp.layout import JOINTS, MOMENTUM, NU, NV, NX, POSITION, ROTATION
from surefoot.components.ocp.node_reference import NodeReference
from surefoot.components.ocp.probing_force import ProbingForce
from surefoot.components.ocp.quadratic_model import QuadraticModel
from surefoot.components.ocp.relaxed_barrier import RelaxedBarrier
from surefoot.components.ocp.riccati import Riccati, SolverFailed, StageQP
from surefoot.components.ocp.support_polygon import SupportPolygon
from surefoot.components.ocp.term import Nodes, Term
from surefoot.components.ocp.tracking import Tracking
from surefoot.components.robot_model import LegKinematics
from surefoot.components.robot_model.rotations import exp_rotations, log_rotations
from surefoot.config.ocp import Ocp
from surefoot.config.robot import Robot

_FORCE_FLOOR_N = 1.0
"""A stance foot's iterate stays above this: its least force is the barrier's affair."""


def compose(settings: Ocp, robot: Robot) -> tuple[Tracking, tuple[Term, ...]]:
    """Eq. (2), the inequalities of eqs. (3)-(6) with the figures of Table I, and the loads of the footholds."""

    def barrier(name: str) -> RelaxedBarrier:
        figures = getattr(settings, name)
        return RelaxedBarrier(figures.mu, figures.delta)

    legs = LegKinematics(robot)
    return Tracking(settings.weights), (
        FrictionCone(barrier("friction_cone"), settings.friction, settings.cone_regularisation_n2),
        ForceLimits(barrier("force_limits"), settings.force_min_n, settings.force_max_n),
        FootPlacement(barrier("foot_placement")),
        JointPositionLimits(barrier("joint_position"), legs.lower, legs.upper),
        JointVelocityLimits(barrier("joint_velocity"), settings.joint_velocity_limit),
        SupportPolygon(barrier("support_polygon")),
        ProbingForce(barrier("probing_force")),
        CertifiedLoad(settings.certified_load),
    )


@dataclass(frozen=True)
class State:
    """A measured state: x(t_i) of eq. (1b).

    Attributes:
        h: (6,) normalised momentum; p_WB: (3,); R_WB: (3, 3); q: (4, 3).
    """

    h: np.ndarray
    p_WB: np.ndarray
    R_WB: np.ndarray
    q: np.ndarray


@dataclass(frozen=True)
class Step:
    """What one SQP iteration did.

    Attributes:
        iterate: the new trajectory.
        nodes: the old one with its linearisation, which holds until the problem's next.
        scale: share of the full Newton step that was taken.
        size: largest state change of the full step.
    """

    iterate: Trajectory
    nodes: Nodes
    scale: float
    size: float


def _ignore(stage: str) -> None:
    """Nobody measures."""


class Problem:
    """Eqs. (1)-(6) over N intervals for one robot."""

    def __init__(self, settings: Ocp, robot: Robot, N: int):
        self.N = N
        self.settings = settings
        self.dynamics = CentroidalDynamics(robot, N)
        self.tracking, self.constraints = compose(settings, robot)
        self._qp = StageQP(N, NX, NU, self.dynamics.F)
        self._model = QuadraticModel(self._qp)
        self._riccati = Riccati(self._qp)

    def cold_start(self, reference: NodeReference) -> Trajectory:
        """The reference as the first iterate; its lifted velocities settle in the first iteration."""
        N = self.N
        contact = reference.contact[:N, :, None]
        return Trajectory(
            h=np.zeros((N + 1, 6)),
            p_WB=reference.p_WB.copy(),
            R_WB=reference.R_WB.copy(),
            q=reference.q.copy(),
            force_W=contact * reference.force_W[:N],
            foot_velocity_W=~contact * reference.v_WF[:N],
            v=np.zeros((N, NV)),
        )

    def linearise(self, iterate: Trajectory, reference: NodeReference) -> Nodes:
        """Everything the terms need, about an iterate; holds until the next call."""
        N, normal = self.N, reference.normal_W
        linear = self.dynamics.linearise(
            iterate,
            reference.contact[:N],
            reference.dt,
            normal,
            reference.v_WF[:N] @ normal,
            self.settings.swing_height_gain,
            reference.p_WF[:N] @ normal,
        )
        return Nodes(iterate, linear, reference)

    def quadratic(self, nodes: Nodes, x0: np.ndarray) -> StageQP:
        """The QP of an SQP iteration; `x0` (24,) is the measured state's deviation from the iterate."""
        model, qp = self._model, self._qp
        model.clear()
        self.tracking.add(nodes, model)
        for constraint in self.constraints:
            constraint.add(nodes, model)
        model.write(nodes.linear)
        qp.x0[:] = x0
        return qp

    def iterate(
        self, iterate: Trajectory, reference: NodeReference, measured: State, mark: Callable[[str], None] = _ignore
    ) -> Step:
        """One SQP iteration from `iterate`; `mark` is told the name of each stage as it ends.

        Raises:
            SolverFailed: the QP has no solution; the iterate is left as it was.
        """
        nodes = self.linearise(iterate, reference)
        x0 = np.empty(NX)
        x0[MOMENTUM] = measured.h - iterate.h[0]
        x0[POSITION] = measured.p_WB - iterate.p_WB[0]
        x0[ROTATION] = log_rotations((iterate.R_WB[0].T @ measured.R_WB)[None])[0]
        x0[JOINTS] = (measured.q - iterate.q[0]).ravel()
        mark("linearise")
        self.quadratic(nodes, x0)
        mark("quadratic")
        dx, du = self._riccati.solve()
        mark("riccati")
        step = self._take(nodes, dx, du)
        mark("step")
        return step

    def converge(
        self, reference: NodeReference, measured: State, iterations: int, tolerance: float
    ) -> tuple[Step, int]:
        """SQP from a cold start until the step is below `tolerance`, or for `iterations` of them.

        Raises:
            SolverFailed: a QP failed.
        """
        trajectory = self.cold_start(reference)
        count, size = 0, np.inf
        while count < iterations and size >= tolerance:
            step = self.iterate(trajectory, reference, measured)
            trajectory, size = step.iterate, step.size
            count += 1
        return step, count

    def violations(self, nodes: Nodes) -> dict[str, float]:
        """Largest violation of each constraint over the horizon, in its own unit."""
        return {constraint.name: constraint.violation(nodes) for constraint in self.constraints}

    def _take(self, nodes: Nodes, dx: np.ndarray, du: np.ndarray) -> Step:
        """Apply a step, scaled so that neither forces nor states leap, forces back in their cone."""
        settings, old, linear = self.settings, nodes.iterate, nodes.linear
        contact = nodes.reference.contact[: self.N]
        du_legs = du.reshape(self.N, 4, 3)
        force_change = float(np.abs(du_legs * contact[..., None]).max())
        size = float(np.abs(dx).max())
        scale = min(1.0, settings.step_force_n / max(force_change, 1e-9), settings.step_state / max(size, 1e-9))
        # The first node is the measured state: it is taken in full whatever the scale.
        share = np.full((self.N + 1, 1), scale)
        share[0] = 1.0
        dx = share * dx
        du_legs = scale * du_legs
        dv = scale * linear.v_c + (linear.v_u @ (scale * du)[..., None] + linear.v_x @ dx[:-1, :, None])[..., 0]
        new = replace(
            old,
            h=old.h + dx[:, MOMENTUM],
            p_WB=old.p_WB + dx[:, POSITION],
            R_WB=old.R_WB @ exp_rotations(dx[:, ROTATION]),
            q=old.q + dx[:, JOINTS].reshape(-1, 4, 3),
            force_W=self._admissible(old.force_W + du_legs, nodes.reference) * contact[..., None],
            foot_velocity_W=(old.foot_velocity_W + du_legs) * ~contact[..., None],
            v=old.v + dv,
        )
        if not np.isfinite(new.v).all():
            raise SolverFailed("sqp: the step is not finite; start again from the reference")
        return Step(new, nodes, scale, size)

    def _admissible(self, force_W: np.ndarray, reference: NodeReference) -> np.ndarray:
        """Forces clipped to the limits and the cone; the defects of the next iteration absorb the change."""
        normal, settings = reference.normal_W, self.settings
        along = force_W @ normal
        clipped = np.clip(along, _FORCE_FLOOR_N, settings.force_max_n)
        tangential = force_W - along[..., None] * normal
        length = np.sqrt((tangential**2).sum(axis=-1))
        shrink = np.minimum(1.0, settings.friction * clipped / np.maximum(length, 1e-9))
        return clipped[..., None] * normal + shrink[..., None] * tangential


def policy_states(iterate: Trajectory) -> np.ndarray:
    """(N+1, 24) states as messages carry them: the base's rotation as roll, pitch, yaw (ZYX)."""
    R = iterate.R_WB
    x = np.empty((len(R), NX))
    x[:, MOMENTUM], x[:, POSITION] = iterate.h, iterate.p_WB
    x[:, 9] = np.arctan2(R[:, 2, 1], R[:, 2, 2])
    x[:, 10] = np.arcsin(np.clip(-R[:, 2, 0], -1.0, 1.0))
    x[:, 11] = np.arctan2(R[:, 1, 0], R[:, 0, 0])
    x[:, JOINTS] = iterate.q.reshape(len(R), 12)
    return x
