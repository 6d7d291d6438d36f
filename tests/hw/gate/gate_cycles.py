"""A standing robot, a command that suits it, and cycles of the gate."""

from dataclasses import replace

import numpy as np

from surefoot.bus.messages import JointCommand
from surefoot.config.hw import Hw
from surefoot.config.robot import load_robot
from surefoot.hw.gate.limits import Limits
from surefoot.hw.robot_interface import Sensors

ROBOT = load_robot("aliengo")
SETTINGS = Hw()
LIMITS = Limits(ROBOT, SETTINGS.gate)
STAND = np.tile(ROBOT.nominal.stand_q, 4)
NOTHING = np.zeros(12)
DAMPING = {"kp": NOTHING, "tau": NOTHING, "solver": "ok"}
GOOD = JointCommand(t=1.0, valid=True, q=STAND, kp=np.full(12, 10.0), kd=np.ones(12), tau=np.full(12, 3.0))
STILL = Sensors(
    q=STAND, dq=NOTHING, tau=np.full(12, 3.0), omega_WB_B=np.zeros(3), acc_B=np.array([0.0, 0.0, 9.81])
)
LAW = ("q", "dq", "kp", "kd", "tau")


def at(t, **fields):
    """The good command of a time [s], but for some fields."""
    return replace(GOOD, t=t, **fields)


def entry(values, index, value):
    """A copy with one entry changed."""
    values = np.array(values)
    values[index] = value
    return values


def cycles(gate, t0, t1, make=lambda t: None, sensors=STILL):
    """Every cycle from t0 to t1 [s], with the command that `make(t)` gives; whether the last one damped.

    The gyroscope has a noise: one without is stuck.
    """
    for cycle, t in enumerate(np.arange(t0, t1, 0.002)):
        noise = np.array([0.0, 0.0, 1e-9 * (cycle % 2)])
        gate.law(make(t), replace(sensors, omega_WB_B=sensors.omega_WB_B + noise), t)
    return gate.damping


def brakes(law):
    """Whether a law is the safe state."""
    return not (law.kp.any() or law.dq.any() or law.tau.any()) and (law.kd == SETTINGS.damping_kd).all()


def torque(law, sensors):
    """(12,) of a law where the joints are [N m]."""
    return law.tau + law.kp * (law.q - sensors.q) + law.kd * (law.dq - sensors.dq)
