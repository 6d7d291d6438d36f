"""What a recording says of itself."""

from __future__ import annotations

import json
from datetime import UTC, datetime
from importlib.metadata import version
from typing import Any

from surefoot.tools.evaluation.source import source_digest
from surefoot.tools.recording.numerics import numerics


def about(config: dict[str, Any], how: str) -> dict[str, str]:
    """The metadata of a recording.

    Args:
        config: the resolved configuration as tables.
        how: it was made: "run", "record" on a running bus, "lockstep", "clip".
    """
    return {
        "config": json.dumps(config, sort_keys=True),
        "version": version("surefoot"),
        "source": source_digest(),
        "numerics": numerics(),
        "made": datetime.now(UTC).isoformat(timespec="seconds"),
        "how": how,
    }
