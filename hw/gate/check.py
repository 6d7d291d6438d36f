"""The table of everything that the gate looks at, and what it does about it."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum


class Answer(Enum):
    """What happens in the cycle in which a check is broken."""

    CUT = "cut"
    """No torque at all: every gain and torque is zero."""
    DAMP = "damp"
    """Every joint is braked, none is driven."""
    HOLD = "hold"
    """The last law that passed stays, feed-forward included, for `hw.gate.hold_s` at the most; then damp."""
    CLAMP = "clamp"
    """The law passes with what is too much of it taken off."""
    WARN = "warn"
    """The law passes; it is only said."""


class Latch(Enum):
    """When damping stays until a person clears it."""

    AT_ONCE = "at once"
    LATER = "after `hw.latch_after_s`"
    """Counted from the last law that passed; before the first one never."""
    NEVER = "never"


class Check(Enum):
    """One row each, the gravest first: of several of one answer the first is told.

    Attributes:
        what: the thing looked at.
        answer: to a violation.
        limit: settings, or figures of the robot, by their paths; empty where there is no number.
        latch: when the violation outlasts its cause.
        remedy: in words, as part of the reason; empty where there is nothing to be done.
    """

    # fmt: off
    CUT = ("torque cut by a person (`surefoot cut`)", Answer.CUT, "", Latch.AT_ONCE,
           "when nobody is near the robot: command damp, then stand")
    STOP = ("not damped in time after `surefoot stop` or `damp`, or freed from a cut", Answer.DAMP, "",
            Latch.AT_ONCE, "")
    TILT = ("tilt of the trunk, by gyroscope and accelerometer", Answer.DAMP, "hw.gate.tilt_max", Latch.AT_ONCE,
            "set the robot upright")
    IMU = ("IMU of which no figure changes", Answer.DAMP, "hw.gate.imu_stuck_cycles", Latch.AT_ONCE,
           "switch the robot off and on")
    ENCODER = ("angle that stays the same to the last digit while its joint has to move", Answer.DAMP,
               "hw.gate.encoder_stuck_cycles and hw.gate.encoder_moved", Latch.AT_ONCE,
               "switch the robot off and on")
    MOTOR = ("measured torque that is not what the laws ask for", Answer.DAMP,
             "hw.gate.motor_torque_off, hw.gate.motor_torque_share and hw.gate.motor_off_cycles", Latch.AT_ONCE,
             "does this motor still work?")
    POWER = ("power of all motors: 6 more cycles above the limit than below", Answer.DAMP, "hw.gate.power",
             Latch.AT_ONCE, "is a leg stuck?")
    HOT = ("temperature of a motor", Answer.DAMP, "hw.gate.temperature_max", Latch.AT_ONCE, "let it cool")
    END_STOP = ("measured angle", Answer.DAMP, "the joint's range and hw.gate.beyond_stop", Latch.AT_ONCE,
                "is its encoder sound, and hw.unit this robot's?")
    SPEED = ("measured speed", Answer.DAMP, "the joint's velocity_limit x hw.gate.speed_share", Latch.LATER,
             "has the foot lost the ground?")
    ABSENT = ("no command yet", Answer.DAMP, "", Latch.LATER, "")
    INVALID = ("command that its controller does not vouch for", Answer.DAMP, "", Latch.LATER, "see wbc's status")
    OLD = ("age of the command", Answer.DAMP, "hw.command_timeout_s", Latch.LATER, "is wbc running?")
    SHAPE = ("shape of the command", Answer.DAMP, "", Latch.LATER, "is wbc of the same version?")
    NOT_FINITE = ("command that is not finite", Answer.DAMP, "", Latch.LATER, "is the estimate sound?")
    GAINS = ("gains of the command", Answer.DAMP, "hw.kp_max and hw.kd_max", Latch.LATER, "lower wbc's")
    FIRST = ("torque by the angle error of the first law after damping", Answer.DAMP, "hw.gate.first_torque",
             Latch.LATER, "it would throw the robot from where it lies")
    NO_MEASUREMENT = ("measurements that are not finite, or a million and more", Answer.HOLD, "", Latch.LATER,
                      "is the link sound?")
    STALE = ("age of the measurements", Answer.HOLD, "hw.gate.state_timeout_s", Latch.LATER,
             "does the robot answer?")
    ANGLE = ("angle of the command", Answer.CLAMP, "the joint's range", Latch.NEVER,
             "does the plan reach too far?")
    RATE = ("speed of the command", Answer.CLAMP, "the joint's velocity_limit", Latch.NEVER,
            "is the plan too fast?")
    FEED_FORWARD = ("torque of the command", Answer.CLAMP, "the joint's torque_limit x hw.gate.torque_share",
                    Latch.NEVER, "is the load too heavy?")
    TORQUE = ("torque of the whole law where the joint is", Answer.CLAMP,
              "the joint's torque_limit x hw.gate.torque_share", Latch.NEVER, "is its reference far away?")
    TORQUE_STEP = ("change of that torque from law to law", Answer.CLAMP, "hw.gate.torque_step", Latch.NEVER,
                   "does wbc jump?")
    WARM = ("temperature of a motor", Answer.WARN, "hw.gate.temperature_warn", Latch.NEVER, "let it rest soon")
    # fmt: on

    def __init__(self, what: str, answer: Answer, limit: str, latch: Latch, remedy: str):
        self.what, self.answer, self.limit, self.latch, self.remedy = what, answer, limit, latch, remedy


@dataclass(frozen=True)
class Violation:
    """A check that is broken.

    Attributes:
        check: which.
        found: in words, with value and limit.
    """

    check: Check
    found: str

    def __str__(self) -> str:
        return f"{self.found}: {self.check.remedy}" if self.check.remedy else self.found
