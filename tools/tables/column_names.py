"""What the numbers of a field are called where a table has one column for each of them."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product

from surefoot.bus.message import FieldSpec
from surefoot.config.robot import JOINT_NAMES, LEGS

_POSE = ("x", "y", "z", "roll", "pitch", "yaw")
_XYZ, _QUATERNION = ("x", "y", "z"), ("w", "x", "y", "z")

_NOT_BY_LEG = ("leg_order", "region_a", "region_b")
"""Their four entries are places in an order, or sides of a region."""


def column_names(field: str, spec: FieldSpec) -> list[str]:
    """Names of the numbers of a field in the order of its array: `q_FL_hip`, `p_WF_FL_x`, `quat_WB_w`.

    Args:
        field: its name.
        spec: its shape; that of an open length stays one column.
    """
    if spec.kind != "array" or -1 in spec.shape:
        return [field]
    return ["_".join((field, *labels)) for labels in product(*_axes(field, spec.shape))]


def _axes(field: str, shape: tuple[int, ...]) -> list[Sequence[str]]:
    """Names along each axis: legs along a first of four, coordinates along a last of three; numbers elsewhere."""
    if field.startswith("quat_"):
        return [_QUATERNION]
    axes: list[Sequence[str]] = [[str(number) for number in range(length)] for length in shape]
    if shape[0] == len(LEGS) and field not in _NOT_BY_LEG:
        axes[0] = LEGS
    if shape[-1] == len(_XYZ):
        axes[-1] = _XYZ
    if shape == (len(JOINT_NAMES),):
        axes = [JOINT_NAMES]
    if shape == (len(_POSE),):
        axes = [_POSE]
    return axes
