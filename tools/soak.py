"""A long run of the emulated robot, and whether memory and open files of every process stay what they are."""

from __future__ import annotations

import csv
import os
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from statistics import median

from surefoot.tools.process_tree import Held, held_below

MAY_GROW_MB = 8.0
"""By which a process's memory may differ between the second and the last quarter of a run."""

_CLI = (sys.executable, "-P", "-m", "surefoot.tools.cli")
_STOP_S = 30.0
_SAYS_S = 60.0  # until the emulator has said where it answers

Say = Callable[[str], None]


@dataclass(frozen=True)
class Growth:
    """What became of one process, from the median of the second quarter of its samples to that of the last.

    Attributes:
        name: of the process.
        samples: how many there are.
        rss_mb, files: at either time.
    """

    name: str
    samples: int
    rss_mb: tuple[float, float]
    files: tuple[float, float]

    @property
    def flat(self) -> bool:
        """Neither memory nor files have become more than they may."""
        return self.rss_mb[1] - self.rss_mb[0] <= MAY_GROW_MB and self.files[1] <= self.files[0]

    def __str__(self) -> str:
        (mb0, mb1), (files0, files1) = self.rss_mb, self.files
        grown = "" if self.flat else "  GREW"
        return f"{self.name:14} {mb0:8.1f} {mb1:8.1f} MB {files0:6.0f} {files1:6.0f} files{grown}"


def growth(samples: Sequence[dict[str, Held]]) -> list[Growth]:
    """Of every process that is in at least four samples."""
    found = []
    for name in dict.fromkeys(name for sample in samples for name in sample):
        held = [sample[name] for sample in samples if name in sample]
        quarter = len(held) // 4
        if quarter:
            early, late = held[quarter : 2 * quarter], held[-quarter:]
            found.append(
                Growth(
                    name,
                    len(held),
                    (median(each.rss_mb for each in early), median(each.rss_mb for each in late)),
                    (median(each.files for each in early), median(each.files for each in late)),
                )
            )
    return found


def soak(
    config: Path, settings: Sequence[str], seconds: float, every_s: float, out: Path, say: Say
) -> tuple[int, list[Growth]]:
    """Start an emulator and a run that speaks to it, and sample every process until the run is over.

    Args:
        config: a deployment of an emulated robot in simulated time.
        settings: overrides for both.
        seconds: of the run's time.
        every_s: between samples, of wall time.
        out: folder for the samples, the logs and what both have said.
        say: told where the run stands, now and then.

    Returns:
        The run's exit code, and what became of each process.
    """
    out.mkdir(parents=True, exist_ok=True)
    words = [str(config), *(word for setting in settings for word in ("--set", setting))]
    samples: list[dict[str, Held]] = []
    with ExitStack() as stack:
        emulator = _start(stack, ["emulator", *words], out / "emulator.txt")
        _await(out / "emulator.txt", emulator)
        run_words = ["run", *words, "--plain", "--for", str(seconds), "--set", f"run.log_dir={out / 'log'}"]
        run = _start(stack, run_words, out / "run.txt")
        begun = time.monotonic()
        table = csv.writer(stack.enter_context((out / "samples.csv").open("w", newline="")))
        table.writerow(("wall_s", "process", "rss_mb", "files"))
        while run.poll() is None and emulator.poll() is None:
            wall = time.monotonic() - begun
            samples.append(held_below(os.getpid()))
            for name, held in samples[-1].items():
                table.writerow((f"{wall:.0f}", name, f"{held.rss_mb:.1f}", held.files))
            say(f"{wall:.0f} s of wall time: {len(samples[-1])} processes")
            time.sleep(every_s)
        code = run.poll()
        return (1 if code is None else code), growth(samples)


def _start(stack: ExitStack, words: Sequence[str], said: Path) -> subprocess.Popen:
    output = stack.enter_context(said.open("wb"))
    process = subprocess.Popen([*_CLI, *words], stdout=output, stderr=subprocess.STDOUT)
    stack.callback(_stop, process)
    return process


def _stop(process: subprocess.Popen) -> None:
    if process.poll() is None:
        process.terminate()
    try:
        process.wait(_STOP_S)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()


def _await(said: Path, emulator: subprocess.Popen) -> None:
    """Until the emulator answers, has ended, or is given up: then the run says what is missing."""
    end = time.monotonic() + _SAYS_S
    while "answers at" not in said.read_text() and emulator.poll() is None and time.monotonic() < end:
        time.sleep(0.1)
