"""Rendering where there is no display: work that needs MuJoCo's renderer, with the first backend that works here.

Whatever goes wrong with a renderer costs pictures only: each attempt has a process of its own.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager

from surefoot.tools.evaluation.workers import Work, run_apart

BACKENDS = ("egl", "osmesa")
"""What MuJoCo can draw with where there is no display, in the order in which they are tried."""

NO_RENDERER = "no_renderer"
"""In the result of work: why its backend cannot draw. Then the next one is tried."""


class Offscreen:
    """Does work with the first backend that draws; one that has failed is not tried again."""

    def __init__(self, backends: Sequence[str] = BACKENDS):
        """`MUJOCO_GL`, where it is set, says which backend is wanted."""
        asked = os.environ.get("MUJOCO_GL", "")
        self._backends = [asked] if asked else list(backends)
        self._reasons: list[str] = []

    def run(self, work: Work, call: tuple) -> dict:
        """The result of `work(*call)`, done in a process of its own.

        Where the work raised, the result has its `failure`; where nothing can draw, `NO_RENDERER` says why.
        """
        while self._backends:
            backend = self._backends[0]
            with _environment("MUJOCO_GL", backend):
                ((_, told),) = run_apart(work, [call], 1)
            if NO_RENDERER not in told and "worker died" not in told.get("failure", ""):
                return told
            self._reasons.append(f"{backend}: {told.get(NO_RENDERER, told.get('failure'))}")
            self._backends.pop(0)
        return {NO_RENDERER: f"no renderer on this machine ({'; '.join(self._reasons) or 'none was tried'})"}


@contextmanager
def _environment(name: str, value: str) -> Iterator[None]:
    """A variable for the processes started meanwhile: MuJoCo reads it when it is imported."""
    before = os.environ.get(name)
    os.environ[name] = value
    try:
        yield
    finally:
        if before is None:
            del os.environ[name]
        else:
            os.environ[name] = before
