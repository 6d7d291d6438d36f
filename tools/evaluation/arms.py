"""Experimental arms: named changes of a deployment."""

from __future__ import annotations

from surefoot.config.typed_toml import ConfigError

TRUE_STATE = "true_state"
"""The arm whose estimator is ideal: no setting, but another component."""

ARMS = {
    "full": (),
    "mpc_only": ("fsm.probing=false", "fsm.support_polygon=false"),
    "no_support_polygon": ("fsm.support_polygon=false",),
    "no_probe_around": ("fsm.probe_around=false",),
    TRUE_STATE: (),
}
"""Overrides of each arm without a figure."""

FIGURED = {"fixed_force": "fsm.fixed_force_n", "threshold": "fsm.collapse_m"}
"""Arms written NAME=FIGURE, and the setting the figure goes to."""


def arm_overrides(arm: str) -> tuple[str, ...]:
    """The overrides of an arm.

    Raises:
        ConfigError: no such arm, or its figure is missing; the message lists the arms.
    """
    name, equals, figure = arm.partition("=")
    if name in FIGURED and figure:
        return (f"{FIGURED[name]}={figure}",)
    if name in ARMS and not equals:
        return ARMS[name]
    known = ", ".join([*ARMS, *(f"{each}=FIGURE" for each in FIGURED)])
    raise ConfigError(f"no arm {arm!r}; there are {known}")
