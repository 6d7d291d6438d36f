"""Weights and barriers of the optimal control problem, eqs. (1)-(6) and Table I."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Annotated

from surefoot.config.quantities import ConeRounding, Friction, InputWeight, LeastForce, MostForce, Weight
from surefoot.config.typed_toml import Tuned, Within, ordered

Vector3 = tuple[Weight, Weight, Weight]
Step = Annotated[float, Within(1.0, 1e4)]


@dataclass(frozen=True)
class Barrier:
    """Relaxed log-barrier of Table I."""

    mu: Tuned[Annotated[float, Within(0.0, 1e4)]]
    delta: Tuned[Annotated[float, Within(1e-4, 10.0)]]  # > 0, where the logarithm ends; in the constraint's unit


@dataclass(frozen=True)
class Weights:
    """Eq. (2); per node, without a factor of the interval. Base weights are shared by mpc and trajopt."""

    linear_momentum: Tuned[Vector3] = (50.0, 50.0, 200.0)  # of h/m [1/(m/s)^2]
    angular_momentum: Tuned[Vector3] = (300.0, 1000.0, 1000.0)  # of h/m [1/(m^2/s)^2]
    # Softer position weights let the support polygon's barrier carry the base to the analytic centre.
    base_position: Tuned[Vector3] = (2e4, 2e4, 2e4)  # [1/m^2]
    base_rotation: Tuned[Vector3] = (1000.0, 3000.0, 3000.0)  # [1/rad^2]
    joints: Tuned[Vector3] = (2.0, 2.0, 1.0)  # hip, thigh, calf [1/rad^2]
    force: Tuned[InputWeight] = 1e-2  # sets the bandwidth: at a tenth, delay and noise make the base ring [1/N^2]
    joint_velocity: Tuned[Vector3] = (0.02, 0.02, 0.01)  # [1/(rad/s)^2]
    foot_position: Tuned[Weight] = 2000.0  # W_p; a soft one lets the base drag the swing foot [1/m^2]
    foot_velocity: Tuned[InputWeight] = 10.0  # W_v [1/(m/s)^2]
    terminal_scale: Tuned[Weight] = 10.0  # of momentum and base at the last node; 0 is the paper's (1a)


@dataclass(frozen=True)
class Ocp:
    """The problem that mpc and trajopt share."""

    weights: Weights = field(default_factory=Weights)
    friction_cone: Barrier = Barrier(10.0, 0.1)  # [N]
    foot_placement: Barrier = Barrier(0.1, 0.005)  # [m]
    joint_position: Barrier = Barrier(0.1, 0.01)  # [rad]
    joint_velocity: Barrier = Barrier(0.1, 0.1)  # [rad/s]
    force_limits: Barrier = Barrier(1.0, 0.5)  # [N]
    support_polygon: Barrier = Barrier(100.0, 0.02)  # [m]
    probing_force: Barrier = Barrier(0.7, 0.7)  # [N]
    certified_load: Tuned[Weight] = 0.1  # of a normal force above what its foothold is certified for [1/N^2]
    friction: Friction = 0.5  # mu_c of eq. (3)
    cone_regularisation_n2: ConeRounding = 4.0  # rounds the cone's tip; asks f_n of at least its root over mu_c
    force_min_n: LeastForce = 5.0
    force_max_n: MostForce = 240.0
    joint_velocity_limit: Annotated[float, Within(0.5, 100.0)] = 8.0  # [rad/s], far inside the motors' own
    swing_height_gain: Annotated[float, Within(0.0, 500.0)] = 20.0  # feedback of a swing foot's height error [1/s]
    step_force_n: Step = 150.0  # a full Newton step diverges at events: larger ones are scaled down
    step_state: Annotated[float, Within(0.01, 10.0)] = 0.4

    def __post_init__(self) -> None:
        ordered(self, "force_min_n", "force_max_n", "no force would do for a foot that stands")
