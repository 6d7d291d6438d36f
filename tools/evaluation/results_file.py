"""`results.json` of one evaluation: what it says of itself, and the runs that need not be done again."""

from __future__ import annotations

import json
from collections.abc import Sequence
from importlib.metadata import version
from pathlib import Path

from surefoot.config.deployment import Deployment
from surefoot.config.typed_toml import ConfigError, to_table
from surefoot.tools.evaluation.pooled import is_error
from surefoot.tools.evaluation.source import source_digest
from surefoot.tools.evaluation.summary import summary


class ResultsFile:
    """The runs of one deployment and arm, in `results.json` and `summary.md` of a folder.

    Attributes:
        results: the content of `results.json`.
    """

    def __init__(self, out: Path, scenario: str, arm: str, deployment: Deployment, limit_s: float):
        """Nothing is read or written yet."""
        self._out = out
        self.results: dict = {
            "scenario": scenario,
            "arm": arm,
            "vision": deployment.run.vision,
            "config": to_table(deployment),
            "limit_s": limit_s,
            "version": version("surefoot"),
            "source": source_digest(),
            "runs": [],
        }

    def resume(self) -> None:
        """Take over the runs of an earlier evaluation of the same; one that ended with an error is done again.

        Raises:
            ConfigError: the file there holds runs of another evaluation, or is not one of ours.
        """
        path = self._out / "results.json"
        if not path.is_file():
            return
        remedy = f"--fresh forgets the runs in {path}; --out keeps them"
        try:
            kept = json.loads(path.read_text())
            runs = list(kept["runs"])
        except (ValueError, KeyError, TypeError):
            raise ConfigError(f"{path} is not a file of results; {remedy}") from None
        mine = json.loads(json.dumps(self.results))
        for key in mine:
            if key != "runs" and kept.get(key) != mine[key]:
                raise ConfigError(f"{path} holds {_other(key, kept.get(key), mine[key])}; {remedy}")
        self.results["runs"] = [run for run in runs if not is_error(run)]

    def missing(self, seeds: Sequence[int]) -> list[int]:
        """The seeds that still have to be done, each once, in the order in which they are asked for."""
        done = {run["seed"] for run in self.results["runs"]}
        return [seed for seed in dict.fromkeys(seeds) if seed not in done]

    def add(self, run: dict) -> None:
        """One more run."""
        self.results["runs"] = sorted([*self.results["runs"], run], key=lambda each: each["seed"])
        self.write()

    def write(self) -> None:
        """Both files, as they stand; a reader, or a crash, never meets half of one."""
        self._out.mkdir(parents=True, exist_ok=True)
        for name, text in (
            ("results.json", json.dumps(self.results, indent=1)),
            ("summary.md", summary(self.results)),
        ):
            unfinished = self._out / f"{name}.part"
            unfinished.write_text(text)
            unfinished.replace(self._out / name)


def _other(key: str, theirs: object, mine: object) -> str:
    """In words how the runs of a file differ from those that were asked for."""
    if key == "source":
        return "runs of another state of the program"
    path, old, new = _difference(key, theirs, mine)
    return f"runs with {path} = {old!r}, asked is {new!r}"


def _difference(path: str, theirs: object, mine: object) -> tuple[str, object, object]:
    """The first entry in which two tables differ."""
    if isinstance(theirs, dict) and isinstance(mine, dict):
        for key in sorted(theirs.keys() | mine.keys()):
            if theirs.get(key) != mine.get(key):
                return _difference(f"{path}.{key}", theirs.get(key), mine.get(key))
    return path, theirs, mine
