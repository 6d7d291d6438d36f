"""Settings of the whole-body controller."""

from __future__ import annotations

from dataclasses import dataclass

Wrench = tuple[float, float, float, float, float, float]


@dataclass(frozen=True)
class Wbc:
    """Gains, weights and limits of the whole-body controller."""

    kp: float = 100.0  # impedance of the base, position and rotation [1/s^2]
    kd: float = 20.0  # [1/s]
    wrench_weight: Wrench = (1.0, 1.0, 2.0, 2.0, 2.0, 1.0)  # force, moment
    force_weight: float = 1e-2  # pull towards the MPC's forces
    probe_force_weight: float = 1.0  # the same for the probing foot
    swing_kp: float = 350.0  # [1/s^2]
    swing_kd: float = 37.0  # [1/s]
    swing_acceleration_max: float = 20.0  # the base feels what the swing leg is given [m/s^2]
    swing_weight: float = 100.0
    acceleration_weight: float = 1e-4
    stance_kp: float = 50.0  # a stance foot that has crept is drawn back [1/s^2]
    stance_kd: float = 20.0  # a stance foot that creeps is braked [1/s]
    friction: float = 0.35  # pyramid inside the paper's cone of 0.5
    force_min_n: float = 10.0  # a lighter stance foot creeps: joint friction alone is worth 3 N at the foot
    force_max_n: float = 240.0
    joint_kp: float = 30.0  # of swing legs, on the robot [N m/rad]
    joint_kd: float = 1.0  # of all legs, on the robot [N m s/rad]
    posture_kp: float = 250.0  # JOINT mode [N m/rad]
    posture_kd: float = 6.0  # JOINT mode [N m s/rad]
    damping_kd: float = 3.0  # DAMP mode [N m s/rad]
    friction_speed: float = 0.2  # joint speed over which compensated Coulomb friction turns round [rad/s]
    hold_s: float = 1.0  # without a policy the base is held this long, then lowered ...
    lower_speed: float = 0.1  # ... at this speed [m/s] ...
    lower_m: float = 0.18  # ... this far, then damped
    blend_s: float = 0.3  # between following a policy and holding, either way
    observer_gain: float = 10.0  # momentum observer's K [1/s]
    observer_force_share: float = 0.25  # largest external force it may claim, of the robot's weight
    observer_moment_max: float = 10.0  # largest external moment it may claim [N m]
    observer_gap_s: float = 0.02  # after a longer gap between cycles it starts anew
    failures_max: int = 5  # successive QP failures before damping
