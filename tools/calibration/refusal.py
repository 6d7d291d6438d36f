"""Why nothing can be concluded."""

from __future__ import annotations


class CannotCalibrate(RuntimeError):
    """The robot does not do what was said, or the figures do not tell; what, the value, the limit, the remedy."""


def refuse_above(what: str, value: float, limit: float, unit: str, remedy: str) -> None:
    """Refuse a value above its limit.

    Raises:
        CannotCalibrate: it is, or it is no number.
    """
    if not value <= limit:
        raise CannotCalibrate(f"{what} = {value:.3g} {unit}, at most {limit:.3g}: {remedy}")


def refuse_below(what: str, value: float, limit: float, unit: str, remedy: str) -> None:
    """Refuse a value below its limit.

    Raises:
        CannotCalibrate: it is, or it is no number.
    """
    if not value >= limit:
        raise CannotCalibrate(f"{what} = {value:.3g} {unit}, at least {limit:.3g}: {remedy}")
