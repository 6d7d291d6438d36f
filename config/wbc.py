"""Settings of the whole-body controller."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from surefoot.config.quantities import Friction, FrictionSpeed, InputWeight, LeastForce, MostForce, Weight
from surefoot.config.typed_toml import Tuned, Within, ordered

Wrench = tuple[Weight, Weight, Weight, Weight, Weight, Weight]
Acceleration = Annotated[float, Within(1.0, 500.0)]
Pause = Annotated[float, Within(0.0, 60.0)]
Claim = Annotated[float, Within(0.0, 2.0)]
Stiffness = Annotated[float, Within(0.0, 1e4)]
Damping = Annotated[float, Within(0.0, 500.0)]  # at 250 Hz a larger one would more than reverse a speed


@dataclass(frozen=True)
class Wbc:
    """Gains, weights and limits of the whole-body controller."""

    kp: Tuned[Stiffness] = 100.0  # impedance of the base, position and rotation [1/s^2]
    kd: Tuned[Damping] = 20.0  # [1/s]
    wrench_weight: Tuned[Wrench] = (1.0, 1.0, 2.0, 2.0, 2.0, 1.0)  # force, moment
    force_weight: Tuned[InputWeight] = 1e-2  # pull towards the MPC's forces
    probe_force_weight: Tuned[InputWeight] = 1.0  # the same for the probing foot
    swing_kp: Tuned[Stiffness] = 350.0  # [1/s^2]
    swing_kd: Tuned[Damping] = 37.0  # [1/s]
    swing_acceleration_max: Acceleration = 20.0  # the base feels what the swing leg is given [m/s^2]
    swing_weight: Tuned[InputWeight] = 100.0
    acceleration_weight: Annotated[float, Within(1e-8, 1.0)] = 1e-4
    stance_kp: Tuned[Stiffness] = 50.0  # a stance foot that has crept is drawn back [1/s^2]
    stance_kd: Tuned[Damping] = 20.0  # a stance foot that creeps is braked [1/s]
    friction: Friction = 0.35  # pyramid about the vertical, inside the paper's cone of 0.5
    force_min_n: LeastForce = 10.0  # a lighter stance foot creeps: joint friction alone is worth 3 N at the foot
    force_max_n: MostForce = 240.0
    joint_kp: Tuned[Annotated[float, Within(0.0, 2000.0)]] = 30.0  # of swing legs, on the robot [N m/rad]
    joint_kd: Tuned[Annotated[float, Within(0.0, 100.0)]] = 1.0  # of all legs, on the robot [N m s/rad]
    posture_kp: Annotated[float, Within(1.0, 2000.0)] = 250.0  # JOINT mode [N m/rad]
    posture_kd: Annotated[float, Within(0.0, 100.0)] = 6.0  # JOINT mode [N m s/rad]
    friction_speed: FrictionSpeed = 0.2  # joint speed over which compensated Coulomb friction turns round [rad/s]
    hold_s: Pause = 1.0  # without a policy the base is held this long, then lowered ...
    lower_speed: Annotated[float, Within(0.005, 1.0)] = 0.1  # ... at this speed [m/s] ...
    lower_m: Annotated[float, Within(0.0, 1.0)] = 0.18  # ... this far, then damped
    blend_s: Annotated[float, Within(0.001, 10.0)] = 0.3  # between following a policy and holding, either way
    observer_gain: Tuned[Annotated[float, Within(0.01, 250.0)]] = 10.0  # momentum observer's K [1/s]
    observer_force_share: Claim = 0.25  # largest external force it may claim, of the robot's weight
    observer_moment_max: Annotated[float, Within(0.0, 500.0)] = 10.0  # largest external moment it may claim [N m]
    observer_gap_s: Annotated[float, Within(0.005, 1.0)] = 0.02  # after a longer gap between cycles it starts anew
    failures_max: Annotated[int, Within(0, 250)] = 5  # successive QP failures before damping

    @property
    def patience_s(self) -> float:
        """How long the robot is held and lowered without the others, before it is damped [s]."""
        return self.hold_s + self.lower_m / self.lower_speed

    def __post_init__(self) -> None:
        ordered(self, "force_min_n", "force_max_n", "no force would do for a foot that stands")
