"""Whatever comes, nothing raises, and the law that leaves is one that a robot may follow."""

import warnings
from dataclasses import replace

import numpy as np
import pytest
from gate_cycles import GOOD, LAW, LIMITS, ROBOT, SETTINGS, STAND, STILL, torque

from surefoot.hw.gate.gate import Gate
from surefoot.hw.robot_interface import Sensors

STRANGE = np.array([np.nan, np.inf, -np.inf, 1.7e308, -1.7e308, 1e6, -1e6, 5e-324, 1e-310, -0.0, 0.0, 500.0, 20.0])
RANGES = {"q": 4.0, "dq": 25.0, "kp": 500.0, "kd": 20.0, "tau": 60.0, "omega_WB_B": 10.0, "acc_B": 30.0}


def figures(rng, name, size, spread, strange):
    """Some of a field, around what it is in a standing robot; a share of the entries is no figure at all."""
    centre = {"q": STAND, "acc_B": STILL.acc_B}.get(name, np.zeros(size))
    values = centre + spread * RANGES.get(name, 100.0) * rng.uniform(-1.0, 1.0, size)
    values = np.abs(values) if name in ("kp", "kd") else values
    return np.where(rng.random(size) < strange, rng.choice(STRANGE, size), values)


def drawn(rng, t):
    """A command and measurements, most of them tame."""
    spread, strange = rng.choice([0.02, 0.1, 1.0]), rng.choice([0.0, 0.5], p=[0.9, 0.1])
    command = replace(
        GOOD,
        t=float(rng.choice([t, t - 0.049, t - 1.0, t + 1.0, np.nan, np.inf], p=[0.8, 0.16, *[0.01] * 4])),
        valid=bool(rng.random() < 0.98),
        solver=str(rng.choice(["ok", "QP failed"])),
        **{name: figures(rng, name, 12, spread, strange) for name in LAW if rng.random() < 0.8},
    )
    if rng.random() < 0.01:
        command = replace(command, tau=np.zeros((3, 4)))
    spread, strange = rng.choice([0.02, 0.1, 1.0], p=[0.5, 0.4, 0.1]), rng.choice([0.0, 0.1], p=[0.9, 0.1])
    sensors = Sensors(
        **{name: figures(rng, name, 12, spread, strange) for name in ("q", "dq", "tau")},
        **{name: figures(rng, name, 3, spread, strange) for name in ("omega_WB_B", "acc_B")},
        temperature=figures(rng, "temperature", 12, spread, strange) if rng.random() < 0.5 else None,
    )
    return None if rng.random() < 0.01 else command, sensors


def soft(gate):
    """Latches and thresholds out of the way, so that more laws reach the limiter."""
    return replace(gate, tilt_max=3.2, power=2000.0, temperature_max=120.0, speed_share=2.0, first_torque=500.0)


@pytest.mark.parametrize("own", [SETTINGS.gate, soft(SETTINGS.gate)], ids=["as it is", "latching less"])
@pytest.mark.parametrize("seed", range(3))
def test_the_law_that_leaves_is_finite_and_within_gains_torques_and_angles(seed, own):
    rng = np.random.default_rng(seed)
    settings = replace(SETTINGS, gate=own)
    gate, t, passed = Gate(ROBOT, settings), 0.0, 0
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for cycle in range(1500):
            if cycle % 20 == 0:
                gate = Gate(ROBOT, settings)
            t += float(rng.choice([0.002, 0.0, 0.3], p=[0.9, 0.05, 0.05]))
            command, sensors = drawn(rng, t)
            now = float(rng.choice([t, np.nan, np.inf], p=[0.98, 0.01, 0.01]))
            law = gate.law(command, sensors, now, float(rng.choice([0.0, 0.031, np.nan], p=[0.9, 0.08, 0.02])))
            assert all(getattr(law, name).shape == (12,) and np.isfinite(getattr(law, name)).all() for name in LAW)
            assert law.kp.min() >= 0.0 and law.kp.max() <= 500.0
            assert law.kd.min() >= 0.0 and law.kd.max() <= 20.0
            acts = law.kp > 0.0
            assert ((law.q >= LIMITS.lower) & (law.q <= LIMITS.upper) | ~acts).all()
            assert (np.abs(law.dq) <= LIMITS.speed).all() and (np.abs(law.tau) <= LIMITS.torque).all()
            assert isinstance(gate.reason, str) and (gate.reason or not gate.damping)
            if not gate.damping and "measure" not in gate.reason:
                passed += 1
                assert (np.abs(torque(law, sensors)) <= LIMITS.torque * (1.0 + 1e-9) + 1e-6).all()
    assert passed > 150
