"""How long the MPC takes to solve on this machine, and whether that is fast enough for real time."""

from __future__ import annotations

import os
from time import perf_counter

import numpy as np

from surefoot.bus.messages import ControlMode, MotionReference, StateEstimate
from surefoot.bus.topics import MPC_RATE_HZ
from surefoot.components.component import Inbox, Outbox
from surefoot.components.robot_model import LegKinematics
from surefoot.config.deployment import Deployment

_SOLVES = 60
_UP = np.array([0.0, 0.0, 1.0])


def median_solve_ms(deployment: Deployment, solves: int = _SOLVES) -> float:
    """Median wall time of a step of the MPC for a robot that stands and shifts its base [ms]."""
    from surefoot.components.mpc.mpc import Mpc  # slow; with simulated time nobody asks

    robot = deployment.load_robot()
    mpc = Mpc(deployment)
    mpc.warm_up()
    inbox, outbox = Inbox(mpc.inputs), Outbox(mpc.outputs, lambda key, message: None)
    q = np.tile(robot.nominal.stand_q, 4)
    pose = np.array([0.0, 0.0, robot.nominal.leg_height, 0.0, 0.0, 0.0])
    feet = pose[:3] + LegKinematics(robot).position(q.reshape(4, 3))
    period = 1.0 / MPC_RATE_HZ[deployment.mpc.profile]
    took = []
    for tick in range(solves):
        t = tick * period
        still = {"t": t, "valid": True, "p_WF": feet, "normal_W": _UP}
        inbox.deliver(
            "state/estimate", StateEstimate(p_WB=pose[:3], quat_WB=np.array([1.0, 0.0, 0.0, 0.0]), q=q, **still)
        )
        inbox.deliver(
            "fsm/reference",
            MotionReference(
                mode=ControlMode.BALANCE,
                leg_status=np.zeros(4, int),
                base_from=pose,
                base_to=pose + [0.05, 0.02, 0.0, 0.0, 0.0, 0.0],
                base_t1=1.0,
                **still,
            ),
        )
        begun = perf_counter()
        mpc.step(t, inbox, outbox)
        took.append(1e3 * (perf_counter() - begun))
        inbox.clear_new()
    return float(np.median(took))


def light_profile_reason(deployment: Deployment) -> str:
    """Why this machine must run the MPC's light profile, in words; empty when the paper's fits."""
    period_ms = 1e3 / MPC_RATE_HZ["paper"]
    took, cores = median_solve_ms(deployment), len(os.sched_getaffinity(0))
    share = took / period_ms
    reasons = []
    if share > deployment.run.solve_share_max:
        allowed = 100 * deployment.run.solve_share_max
        reasons.append(
            f"a solve takes {took:.1f} ms, {100 * share:.0f} % of its {period_ms:.0f} ms, limit {allowed:.0f} %"
        )
    if cores < deployment.run.cores_min:
        reasons.append(f"{cores} cores for seven processes, at least {deployment.run.cores_min} wanted")
    if not reasons:
        return ""
    return (
        f"this machine cannot keep {MPC_RATE_HZ['paper']:.0f} Hz ({'; '.join(reasons)}): the MPC runs its light "
        f"profile, {MPC_RATE_HZ['light']:.0f} Hz; --set mpc.profile=paper insists"
    )
