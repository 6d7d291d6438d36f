"""A hoist that holds the trunk in the air."""

from __future__ import annotations

import mujoco

HOIST_M = 1.0
"""The trunk's height: clear of every terrain with straight legs [m]."""

_SOLREF = (0.004, 1.0)  # as stiff as the physics' step allows: the trunk sags by a fraction of a millimetre
_SOLIMP = (0.99, 0.999, 0.001, 0.5, 2.0)


def hang(spec: mujoco.MjSpec) -> None:
    """Weld the trunk to the world where it hangs, level."""
    spec.body("trunk").pos = [0.0, 0.0, HOIST_M]
    weld = spec.add_equality(
        type=mujoco.mjtEq.mjEQ_WELD, objtype=mujoco.mjtObj.mjOBJ_BODY, name1="trunk", name2="world"
    )
    weld.solref, weld.solimp = _SOLREF, _SOLIMP
