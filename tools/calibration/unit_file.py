"""The robot file on the disk."""

from __future__ import annotations

from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from surefoot.config.typed_toml import to_table
from surefoot.config.unit import Unit, load_unit

_HEAD = """\
# One robot, as `surefoot calibrate` has measured it; `hw.unit` names this file. SI units. Joints FL, FR, RL, RR:
# hip, thigh, calf; feet FL, FR, RL, RR. A section that is left out corrects nothing.
"""


def now() -> str:
    """The date and time of a measurement, UTC."""
    return datetime.now(UTC).isoformat(timespec="minutes")


def known_unit(path: Path, robot: str) -> Unit:
    """What a robot file holds already; nothing where there is none.

    Raises:
        ConfigError: there is one, but it cannot be used.
    """
    return load_unit(path, robot) if path.exists() else Unit(robot)


def write_unit(path: Path, unit: Unit) -> None:
    """Write a robot file; six digits of every figure."""
    lines = [_HEAD, f'robot = "{unit.robot}"']
    for part in unit.parts:
        table = to_table(getattr(unit, part))
        lines += ["", f"[{part}]", *(_line(key, value) for key, value in table.items() if key != "measured")]
        measured = {key: value for key, value in table["measured"].items() if value is not None}
        lines += ["", f"[{part}.measured]", *(_line(key, value) for key, value in measured.items())]
    path.write_text("\n".join(lines) + "\n")


def _line(key: str, value: Any) -> str:
    if isinstance(value, str):
        return f'{key} = "{value}"'
    if isinstance(value, list):
        figures = [f"{each:.6g}" for each in value]
        if len(figures) <= 4:
            return f"{key} = [{', '.join(figures)}]"
        legs = [", ".join(figures[first : first + 3]) for first in range(0, len(figures), 3)]
        return f"{key} = [\n    " + ",\n    ".join(legs) + ",\n]"
    return f"{key} = {value:.6g}"
