"""The last check before the motors: a command passes, is limited, or the cycle damps, and the reason is said."""

from __future__ import annotations

from math import nan

from surefoot.bus.messages import JointCommand
from surefoot.config.hw import Hw
from surefoot.config.robot import Robot
from surefoot.hw.gate.check import Answer, Check, Latch, Violation
from surefoot.hw.gate.command_watch import CommandWatch, damps_as_told, drives
from surefoot.hw.gate.encoder_watch import EncoderWatch
from surefoot.hw.gate.end_stops import EndStops
from surefoot.hw.gate.imu_watch import ImuWatch
from surefoot.hw.gate.limiter import Limiter
from surefoot.hw.gate.limits import Limits
from surefoot.hw.gate.motor_watch import MotorWatch
from surefoot.hw.gate.power_watch import PowerWatch
from surefoot.hw.gate.sensor_watch import SensorWatch
from surefoot.hw.gate.tilt_watch import TiltWatch
from surefoot.hw.robot_interface import MotorLaw, Sensors, damping_law

FREED_BY = "command sit, or damp, then stand"
"""What a person does about a latch; it is part of every reason of one."""

_ORDER = {check: place for place, check in enumerate(Check)}
_ROUNDING_S = 1e-9  # of times that are whole cycles


class Gate:
    """Answers every violation as the table of `Check` says, in the same cycle; of several the gravest counts.

    A latch outlasts its cause. Some causes latch at once; any damping does when it has lasted `latch_after_s`, as
    the robot has left the posture that commands were made for. From then on the gate damps whatever comes, until
    its cause is gone and the whole-body controller damps as well because the state machine tells it to. That is
    left only by a person's command, from the posture in which the robot is by then.

    Attributes:
        damping: whether the last cycle damped, or was cut.
        measured: whether the figures of the last reading can be measurements: finite, and none of a million.
        reason: why it damped, held, limited or warned, with value and limit; empty when nothing was amiss.
    """

    def __init__(self, robot: Robot, settings: Hw):
        limits, own = Limits(robot, settings.gate), settings.gate
        self._settings = settings
        self._commands = CommandWatch(limits, settings)
        self._sensors = SensorWatch(limits, own)
        self._end_stops = EndStops(limits, own)
        self._imu = ImuWatch(own.imu_stuck_cycles)
        self._encoders = EncoderWatch(own)
        self._motors = MotorWatch(robot, own)
        self._power = PowerWatch(own.power)
        self._tilt = TiltWatch(own.tilt_max, own.tilt_filter_s)
        self._limiter = Limiter(limits, own.torque_step)
        self._last = damping_law(settings.damping_kd)
        self._measured_t = nan
        self._passed_t: float | None = None
        self._held_t: float | None = None
        self._latched: Violation | None = None
        self.damping = self.measured = True
        self.reason = "no command yet"

    @property
    def safe_law(self) -> MotorLaw:
        """What acts while nothing may pass: damping, or nothing at all once the torque is cut."""
        return damping_law(0.0 if self._is_cut else self._settings.damping_kd)

    def cut(self, why: str) -> None:
        """No torque from the next law on, whatever comes, until `free`; `why` in the operator's words."""
        self._latched = Violation(Check.CUT, f"torque is cut ({why})")

    def damp(self, why: str) -> None:
        """Latch damping from the next law on; `why` in the operator's words.

        It is cleared like every other latch, and a robot that is damped by its state machine already is not
        latched: there it takes a person's command to move it anyway. What is cut stays cut.
        """
        if not self._is_cut:
            self._latched = Violation(Check.STOP, f"damped by the operator ({why})")

    def free(self) -> None:
        """End a cut, at the operator's word only; nothing else does.

        The gate goes on damping, latched as by `damp`: the robot moves only after two more commands, sit or damp,
        and stand. Without a cut it does nothing: no other latch is cleared past the state machine.
        """
        if self._is_cut:
            self._latched = Violation(Check.STOP, "torque was cut")

    def law(self, command: JointCommand | None, sensors: Sensors, t: float, age_s: float = 0.0) -> MotorLaw:
        """The motor law of a cycle.

        Args:
            command: the newest that has come.
            sensors: this cycle's reading.
            t: of the cycle [s].
            age_s: how long before `t` the reading was measured [s].
        """
        found = self._violations(command, sensors, t, age_s)
        barring = [violation for violation in found if violation.check.answer in (Answer.DAMP, Answer.HOLD)]
        holds = self._holds(barring, t)
        self._latch(None if holds or not barring else barring[0], command, t)
        self.damping = bool(self._latched or (barring and not holds))
        if command is None or self.damping:
            self._last = self.safe_law
        elif not barring:
            self._passed_t = t
            self._last, limited = self._limiter.limited(command, self._last, sensors)
            found += limited
        self._motors.sent(self._last)
        self.reason = self._words(found)
        return self._last

    @property
    def _is_cut(self) -> bool:
        return self._latched is not None and self._latched.check is Check.CUT

    def _violations(
        self, command: JointCommand | None, sensors: Sensors, t: float, age_s: float
    ) -> list[Violation]:
        """What is broken, but for what the law is limited by; the gravest first."""
        driven = drives(self._last)
        is_old = abs(t - age_s - self._measured_t) < _ROUNDING_S
        self._measured_t = t - age_s
        unusable = self._sensors.unusable(sensors, age_s)
        self.measured = unusable is None or unusable.check is not Check.NO_MEASUREMENT
        unfit = self._commands.violation(command, t)
        found = [unusable, unfit]
        if unusable is None:
            found += [
                self._tilt.violation(sensors.omega_WB_B, sensors.acc_B, t),
                self._imu.violation(sensors, driven),
                self._power.violation(sensors.tau, sensors.dq),
                self._sensors.heat(sensors),
                self._end_stops.violation(sensors.q, driven),
                self._sensors.speed(sensors),
            ]
            if not is_old:
                found += self._followed(sensors, driven and not self._settings.dry_run)
            if unfit is None and command is not None and not driven:
                found.append(self._commands.first(command, sensors.q))
        broken = [violation for violation in found if violation is not None]
        return sorted(broken, key=lambda violation: _ORDER[violation.check])

    def _followed(self, sensors: Sensors, driven: bool) -> list[Violation | None]:
        """Whether joints do what they are told to, of a reading that has not been looked at before."""
        encoders = self._encoders.violation(sensors.q, self._last, driven)
        return [encoders, self._motors.violation(sensors, driven)]

    def _holds(self, barring: list[Violation], t: float) -> bool:
        """Whether the last law stays: nothing graver is broken, it drives, and it has not been held too long."""
        if not barring or barring[0].check.answer is not Answer.HOLD:
            self._held_t = None
            return False
        if self._held_t is None:
            self._held_t = t
        return drives(self._last) and t - self._held_t < self._settings.gate.hold_s - _ROUNDING_S

    def _latch(self, cause: Violation | None, command: JointCommand | None, t: float) -> None:
        """Latch by what makes this cycle damp, or let go where a person has seen to it."""
        latched = self._latched
        if cause is None:
            if latched is not None and not self._is_cut and damps_as_told(command):
                self._latched = None
        elif latched is None or latched.check.latch is not Latch.AT_ONCE:
            lasts = self._passed_t is not None and t - self._passed_t >= self._settings.latch_after_s
            if lasts or cause.check.latch is Latch.AT_ONCE:
                self._latched = cause

    def _words(self, found: list[Violation]) -> str:
        latched = self._latched
        if latched is None:
            return "; ".join(map(str, found))
        others = "".join(f"; {violation}" for violation in found if violation.check is not latched.check)
        if self._is_cut:
            return f"{latched}{others}"
        how = "stopped" if latched.check.latch is Latch.AT_ONCE else "damped too long to go on"
        return f"{how} ({latched}): {FREED_BY}{others}"
