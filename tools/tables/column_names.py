"""What the numbers of a field are called: legs, joints and coordinates instead of places in an array."""

from __future__ import annotations

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
    axes = [
        names or [str(number) for number in range(length)]
        for names, length in zip(axis_names(field, spec), spec.shape, strict=True)
    ]
    return ["_".join((field, *labels)) for labels in product(*axes)]


def axis_names(field: str, spec: FieldSpec) -> list[tuple[str, ...]]:
    """Names along each axis of an array: legs along a first of four, coordinates along a last of three, or none.

    Args:
        field: its name.
        spec: its shape.
    """
    shape = spec.shape
    if field.startswith("quat_"):
        return [_QUATERNION]
    if shape == (len(JOINT_NAMES),):
        return [JOINT_NAMES]
    if shape == (len(_POSE),):
        return [_POSE]
    axes: list[tuple[str, ...]] = [() for _ in shape]
    if shape[0] == len(LEGS) and field not in _NOT_BY_LEG:
        axes[0] = LEGS
    if shape[-1] == len(_XYZ):
        axes[-1] = _XYZ
    return axes
