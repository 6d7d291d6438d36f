"""One run of an experiment on disk: made whole or not at all, and made again only when something has changed."""

from __future__ import annotations

import json
import shutil
import signal
from collections.abc import Sequence
from functools import cache
from hashlib import sha256
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

from surefoot.config.typed_toml import to_table
from surefoot.hw.mujoco.scene import build_scene
from surefoot.tools.evaluation.arms import TRUE_STATE
from surefoot.tools.evaluation.one_run import grade
from surefoot.tools.evaluation.pooled import is_error
from surefoot.tools.evaluation.results_file import source_digest
from surefoot.tools.reproduce.recording.forces import ForceSeries
from surefoot.tools.reproduce.recording.instants import Instants
from surefoot.tools.reproduce.recording.map_views import MapViews
from surefoot.tools.reproduce.recording.recorder import Recorder, write_csv
from surefoot.tools.reproduce.run_spec import RunSpec

RECORDERS: dict[str, type[ForceSeries] | type[Instants] | type[MapViews]] = {
    "forces": ForceSeries,
    "instants": Instants,
    "map_views": MapViews,
}
"""By the name of their files."""

_RECORDING = Path(__file__).parent / "recording"


def stamp(spec: RunSpec) -> str:
    """Says what a run follows from: settings, limit, recorders, and the sources it is made by."""
    told = {
        "config": to_table(spec.deployment()),
        "limit_s": spec.limit_s,
        "recorders": spec.recorders,
        "version": version("surefoot"),
        "sources": sources(),
    }
    return sha256(json.dumps(told, sort_keys=True).encode()).hexdigest()


@cache
def sources() -> str:
    """Fingerprint of the sources that decide what a run gives."""
    seen = sha256(source_digest().encode())
    for path in sorted(_RECORDING.rglob("*.py")):
        seen.update(path.name.encode() + b"\0" + path.read_bytes())
    return seen.hexdigest()[:12]


class RecordedRun:
    """A run that is whole.

    Attributes:
        spec: what was run.
        folder: where it lies.
        result: its entry in `results.json`.
        start_x, end_x: of the terrain to be crossed [m].
    """

    def __init__(self, spec: RunSpec, folder: Path):
        self.spec, self.folder = spec, folder
        kept = json.loads((folder / "run.json").read_text())
        self.result: dict = kept["result"]
        self.start_x, self.end_x = kept["field_x_m"]

    def arrays(self, recorder: str) -> dict[str, np.ndarray]:
        """What a recorder has kept."""
        with np.load(self.folder / f"{recorder}.npz") as kept:
            return dict(kept)


def is_whole(spec: RunSpec, folder: Path) -> bool:
    """The folder holds this very run, by these sources."""
    try:
        return json.loads((folder / "run.json").read_text())["stamp"] == stamp(spec)
    except (FileNotFoundError, json.JSONDecodeError, KeyError):
        return False


def record(spec: RunSpec, folder: Path) -> dict:
    """Make a run in this process; it appears under its name once all of it is written.

    Returns:
        Its entry in `results.json`. After an error in the run nothing is kept.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C goes to every process of a terminal: the parent ends us
    deployment = spec.deployment()
    recorders: dict[str, Recorder] = {name: RECORDERS[name](deployment) for name in spec.recorders}
    experiment = folder.parent.parent.name

    def say(line: str) -> None:
        print(f"  {experiment} {spec.name}: {line}", flush=True)

    ideal = spec.arm == TRUE_STATE
    result = grade(deployment, spec.limit_s, say, ideal, list(recorders.values()))
    if is_error(result):
        return result
    _, field = build_scene(deployment, None, friction=1.0)
    kept = {"stamp": stamp(spec), "result": result, "field_x_m": [field.start_x, field.end_x]}
    partial = folder.with_name(f".{folder.name}.part")
    shutil.rmtree(partial, ignore_errors=True)
    partial.mkdir(parents=True)
    for name, recorder in recorders.items():
        arrays: dict[str, Any] = recorder.arrays()
        np.savez_compressed(partial / f"{name}.npz", **arrays)
        write_csv(partial / f"{name}.csv", recorder.columns, recorder.rows())
    (partial / "run.json").write_text(json.dumps(kept | {"config": to_table(deployment)}, indent=1))
    shutil.rmtree(folder, ignore_errors=True)
    partial.rename(folder)
    return result


def by_arm(runs: Sequence[RecordedRun]) -> dict[str, list[RecordedRun]]:
    """Runs under the label of their arm, in the order in which they come."""
    found: dict[str, list[RecordedRun]] = {}
    for run in runs:
        found.setdefault(run.spec.label or run.spec.arm, []).append(run)
    return found
