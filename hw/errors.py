"""What can go wrong near the hardware."""

from __future__ import annotations

from enum import StrEnum


class HardwareFault(RuntimeError):
    """The robot or its simulator cannot go on; says what was measured, the limit and what to do."""


class Flaw(StrEnum):
    """In what a packet is at fault."""

    LENGTH = "length"
    CHECKSUM = "checksum"
    LEVEL = "level flag"
    NOT_FINITE = "not finite"
    IMPLAUSIBLE = "implausible"


class PacketError(ValueError):
    """A packet that must not be used, or a motor law that must not become one.

    Attributes:
        flaw: in what it is at fault.
        what: the thing judged.
        value: what it is.
        limit: what it may be.
        remedy: what to do about it.
    """

    def __init__(self, flaw: Flaw, what: str, value: str, limit: str, remedy: str):
        super().__init__(f"{what} = {value}, {limit}: {remedy}")
        self.flaw, self.what, self.value, self.limit, self.remedy = flaw, what, value, limit, remedy
