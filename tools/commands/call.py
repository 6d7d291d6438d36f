"""What the words of a call mean, and the error of a wrong one."""

from __future__ import annotations

from pathlib import Path

_CONFIG = Path(__file__).resolve().parents[2] / "config"


class CallError(ValueError):
    """A command that cannot be run as it was called; says what would be right."""


def deployment_file(name: str) -> Path:
    """A path as given, or a deployment that comes with the project."""
    own = _CONFIG / f"{name}.toml"
    path = Path(name)
    if path.is_file() or not own.is_file():
        return path
    return own


def deployment_names() -> list[str]:
    """The deployments that come with the project."""
    return sorted(path.stem for path in _CONFIG.glob("*.toml"))


def seeds(text: str) -> list[int]:
    """The seeds of "first:end" or "0,3,7".

    Raises:
        CallError: it is neither.
    """
    try:
        if ":" in text:
            first, _, end = text.partition(":")
            return list(range(int(first), int(end)))
        return [int(each) for each in text.split(",")]
    except ValueError:
        raise CallError(f"--seeds {text!r}: want first:end such as 0:10, or a list such as 0,3,7") from None
