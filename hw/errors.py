"""What can go wrong near the hardware."""


class HardwareFault(RuntimeError):
    """The robot or its simulator cannot go on; says what was measured, the limit and what to do."""
