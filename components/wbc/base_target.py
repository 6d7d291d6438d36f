"""Where the base is to be and what the feet are to press: from the policy, or without one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from surefoot.bus.messages import Policy
from surefoot.components.memory import Memory
from surefoot.components.robot_model.rotation import exp_rotation, log_rotation, matrix_of_rpy, nearer_way
from surefoot.config.robot import GRAVITY
from surefoot.config.wbc import Wbc


@dataclass(frozen=True)
class Target:
    """What the impedance is asked to hold at one instant.

    Attributes:
        p_WB: (3,) [m]; R_WB: (3, 3).
        v_WB_W, omega_WB_W: (3,) [m/s, rad/s].
        force_W: (4, 3) forces of the feet [N].
    """

    p_WB: np.ndarray
    R_WB: np.ndarray
    v_WB_W: np.ndarray
    omega_WB_W: np.ndarray
    force_W: np.ndarray


class BaseTarget:
    """The policy's target while the policy is young; without one the base is held where it was, then lowered.

    Every change between the two fades over `blend_s`, so that neither a policy that is lost nor one that
    returns moves the robot in a jump.

    Attributes:
        held_s: how long the base has been held without a policy; 0 with one [s].
    """

    memory = Memory("held_s", "_with_policy", "_lost_t", "_fade_t", _last=Target, _held=Target, _gap=tuple)

    def __init__(self, settings: Wbc, mass: float):
        self._settings = settings
        self._weight = mass * GRAVITY
        self.reset()

    def reset(self) -> None:
        """Forget the last target: the robot does not balance."""
        self.held_s = 0.0
        self._last: Target | None = None
        self._with_policy = False
        self._lost_t = 0.0
        self._held: Target | None = None
        self._fade_t = -np.inf
        self._gap: tuple[np.ndarray, ...] = ()

    @property
    def lowered(self) -> bool:
        """The base has been lowered as far as it goes: nothing is left but to damp, until the target is reset."""
        return self.held_s > self._settings.patience_s

    def at(
        self, t: float, policy: Policy | None, p_WB: np.ndarray, R_WB: np.ndarray, loads_n: np.ndarray
    ) -> Target:
        """The target at time t.

        Args:
            t: now [s].
            policy: the MPC's, or None where it is missing or stale.
            p_WB, R_WB: where the base is; held at the start, before there was any target.
            loads_n: (4,) what the feet bear when the robot stands still as it is, above 0 on the ground [N]; it
                counts without a policy only.
        """
        if self.lowered:
            policy = None  # one that comes back now would make a robot that lies on the ground leap up
        if policy is not None:
            source = self._of_policy(t, policy)
            self.held_s = 0.0
        else:
            followed = self._last is not None and self._with_policy
            if self._held is None or followed:
                self._lost_t = t
                self._held = self._last or Target(
                    p_WB.copy(), R_WB.copy(), np.zeros(3), np.zeros(3), np.zeros((4, 3))
                )
            source = self._without(t, self._held, loads_n)
            self.held_s = t - self._lost_t
        if self._last is not None and (policy is not None) != self._with_policy:
            self._fade_t, self._gap = t, _difference(self._last, source)
        self._with_policy = policy is not None
        share = min((t - self._fade_t) / self._settings.blend_s, 1.0)
        if share < 1.0:
            source = _add(source, self._gap, 1.0 - share * share * (3.0 - 2.0 * share))
        self._last = source
        return source

    @staticmethod
    def _of_policy(t: float, policy: Policy) -> Target:
        """The policy between its nodes; from one side of +-pi to the other a heading turns the nearer way."""
        position = (t - policy.t) / policy.dt
        k = min(max(int(position), 0), len(policy.u) - 1)
        share = min(max(position - k, 0.0), 1.0)
        change = policy.x[k + 1] - policy.x[k]
        change[9:12] = nearer_way(change[9:12])
        x = policy.x[k] + share * change
        R = matrix_of_rpy(x[9:12])
        return Target(x[6:9], R, R @ policy.v[k, :3], R @ policy.v[k, 3:6], policy.u[k, :12].reshape(4, 3))

    def _without(self, t: float, held: Target, loads_n: np.ndarray) -> Target:
        """Hold the last pose, then lower it, on forces that turn nothing: the weight, shared as statics have it.

        Shared alike, they would turn the robot over a leg that the base has been shifted away from. Before the
        first policy they are: a robot begins in the middle of its feet.
        """
        settings = self._settings
        sinking = min(max(t - self._lost_t - settings.hold_s, 0.0) * settings.lower_speed, settings.lower_m)
        down = np.array([0.0, 0.0, sinking])
        force, stance = np.zeros((4, 3)), loads_n > 0.0
        alike = self._weight / max(int(stance.sum()), 1)
        force[:, 2] = loads_n if held.force_W.any() else alike * stance
        speed = -settings.lower_speed if 0.0 < sinking < settings.lower_m else 0.0
        return Target(held.p_WB - down, held.R_WB, np.array([0.0, 0.0, speed]), np.zeros(3), force)


def static_loads(p_WF: np.ndarray, com_W: np.ndarray, stance: np.ndarray, weight_n: float) -> np.ndarray:
    """(4,) vertical forces of the feet that hold a robot still, the least in squares where more than three stand.

    Their sum is the weight and their moments about the centre of mass cancel. A foot that would have to pull bears
    a newton: the robot is tipping then, and what the others bear is the best that there is.

    Args:
        p_WF: (4, 3) feet [m].
        com_W: (3,) centre of mass [m].
        stance: (4,) feet on the ground; the others bear nothing.
        weight_n: of the robot [N].
    """
    lever = np.where(stance[:, None], p_WF - com_W, 0.0)
    balance = np.stack([stance.astype(float), lever[:, 0], lever[:, 1]])
    loads = np.linalg.pinv(balance) @ np.array([weight_n, 0.0, 0.0])
    return np.where(stance, np.maximum(loads, 1.0), 0.0)


def _difference(a: Target, b: Target) -> tuple[np.ndarray, ...]:
    return (
        a.p_WB - b.p_WB,
        log_rotation(a.R_WB @ b.R_WB.T),
        a.v_WB_W - b.v_WB_W,
        a.omega_WB_W - b.omega_WB_W,
        a.force_W - b.force_W,
    )


def _add(target: Target, gap: tuple[np.ndarray, ...], share: float) -> Target:
    dp, turn, dv, domega, dforce = gap
    return Target(
        target.p_WB + share * dp,
        exp_rotation(share * turn) @ target.R_WB,
        target.v_WB_W + share * dv,
        target.omega_WB_W + share * domega,
        target.force_W + share * dforce,
    )
