"""What a running stack's sensors say, from its bus."""

from __future__ import annotations

from time import monotonic, sleep

from surefoot.bus.codec import decode
from surefoot.bus.messages import HardwareState
from surefoot.bus.session import Session
from surefoot.components.deployment_desk import ask_deployment
from surefoot.tools.calibration.refusal import CannotCalibrate
from surefoot.tools.calibration.samples import Samples, samples_of

_SILENT_S = 5.0
_LOOK_S = 0.05


def check_raw(session: Session, robot: str) -> None:
    """See that the stack's sensors are raw, and of the robot that is meant.

    Raises:
        BusError: the stack does not say.
        CannotCalibrate: a robot file corrects them already, or it is another kind of robot.
    """
    tables = ask_deployment(session)
    if tables.get("robot") != robot:
        raise CannotCalibrate(f"the stack runs robot {tables.get('robot')!r}, not {robot!r}: give its own CONFIG")
    if unit := tables.get("hw", {}).get("unit"):
        raise CannotCalibrate(
            f"the stack's sensors are corrected by {unit} already: run it with --set hw.unit= and calibrate again"
        )


def hear_standing(session: Session, seconds: float) -> Samples:
    """Readings of so much of the run's time [s].

    Raises:
        CannotCalibrate: nothing comes, or the robot damps.
        MessageError: what comes is malformed.
    """
    heard: list[bytes] = []
    session.subscribe("hw/state", lambda key, payload: heard.append(payload))
    states: list[HardwareState] = []
    last = monotonic()
    while not states or states[-1].t - states[0].t < seconds:
        sleep(_LOOK_S)
        new = [decode(HardwareState, payload) for payload in heard[: len(heard)]]
        del heard[: len(new)]
        if new:
            last = monotonic()
        elif monotonic() - last > _SILENT_S:
            raise CannotCalibrate(f"nothing on hw/state for {_SILENT_S:g} s: is io running? see surefoot status")
        states += new
        if states and states[-1].damping:
            raise CannotCalibrate(
                f"the robot damps ({states[-1].gate}): surefoot command stand, and wait until it does"
            )
    return samples_of([state.t for state in states], states)
