"""What the view costs: a live run that is looked at and not looked at by turns."""

from __future__ import annotations

import os
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import viser
from viser._messages import ViewerCameraMessage
from websockets.exceptions import WebSocketException
from websockets.sync.client import connect
from websockets.typing import Subprotocol

from surefoot.bus.topics import CYCLE_HZ, PROCESSES
from surefoot.components.real_time import give_way
from surefoot.config.deployment import load_deployment
from surefoot.tools.commands.call import deployment_file
from surefoot.tools.picture import Picture
from surefoot.tools.supervisor import Supervisor
from surefoot.tools.view.view_process import ViewProcess

SHARE_MAX = 0.10
"""Of a core: what the view may take beside a run."""

_PACE = ("run.clock=monotonic", "run.speed=0.12")
"""A run that the machine keeps up with, at the priority it has beside a robot. One in simulated time takes all
that the cores have: what a view takes is then missing, whatever its priority."""

_FROM_S = 2.0  # the robot stands, and every topic has been published
_WINDOW_S = 8.2  # of the run's time: a status tells the p99 of the last 2000 steps, eight seconds of wbc's
_PAIRS = 3
_TICKS = os.sysconf("SC_CLK_TCK")


def view_bench(folder: Path, config: str = "planks", overrides: tuple[str, ...] = ()) -> dict[str, Any]:
    """Run a deployment and look at it in every second window; takes eight minutes.

    Args:
        folder: for logs.
        config: the deployment.
        overrides: assignments on top of it, and of the pace.

    Returns:
        `view_share`: of a core, in each window with a view; `with` and `without`: of each window `cycle_hz`, the
        robot's cycles for each wall second, and `p99_ms` of each process's steps.

    Raises:
        RuntimeError: the run ended before that.
    """
    file = deployment_file(config)
    settings = [f"run.namespace=bench-{os.getpid()}-view", f"run.log_dir={folder / 'log'}", *_PACE, *overrides]
    deployment = load_deployment(file, settings)
    watch = _Watch(deployment.run.namespace, folder / "view.log")
    try:
        reason = Supervisor(file, settings, deployment).run(watch)
    finally:
        watch.end_view()
    if len(watch.windows) < 2 * _PAIRS:
        raise RuntimeError(f"bench: the run has ended: {reason}")
    seen, unseen = watch.windows[0::2], watch.windows[1::2]
    return {"view_share": [each.pop("share") for each in seen], "with": seen, "without": unseen}


def rows(found: dict[str, Any]) -> Iterator[tuple[str, str, str]]:
    """What was found, as rows `what, asked, got`."""
    share = float(np.median(found["view_share"]))
    missed = "" if share <= SHARE_MAX else "  missed"
    yield "view, beside a run [share of a core]", f"<= {SHARE_MAX:g}", f"{share:6.3f}{missed}"
    cycles = [np.median([each["cycle_hz"] for each in found[name]]) for name in ("with", "without")]
    yield "  cycles/s of the run with a view, without", "", f"{cycles[0]:6.0f} {cycles[1]:6.0f}"
    for process in ("wbc", "mpc", "estimator", "fsm"):
        seen, unseen = (
            np.array([each["p99_ms"][process] for each in found[name]]) for name in ("with", "without")
        )
        higher = f"higher with it in {(seen > unseen).sum()} of {len(seen)} pairs"
        yield (
            f"  {process} p99 with a view, without [ms]",
            "",
            f"{np.median(seen):6.2f} {np.median(unseen):6.2f}  {higher}",
        )


class _Watch:
    """Opens and closes the view by turns, and tells a supervisor when to end."""

    def __init__(self, namespace: str, log: Path):
        self.windows: list[dict[str, Any]] = []
        self._namespace, self._log = namespace, log
        self._view: ViewProcess | None = None
        self._browser: _Browser | None = None
        self._begun: tuple[float, float, float] | None = None

    def __call__(self, picture: Picture) -> str:
        if picture.t < _FROM_S:
            return ""
        if self._begun is None:
            if self._is_seen() and not self._looks():
                return ""
            self._begun = time.monotonic(), picture.t, self._cpu_s()
            return ""
        wall, t, cpu_s = self._begun
        if picture.t < t + _WINDOW_S:
            return ""
        seconds = time.monotonic() - wall
        statuses = {name: picture.processes[name].status for name in PROCESSES}
        window = {
            "cycle_hz": CYCLE_HZ * (picture.t - t) / seconds,
            "p99_ms": {name: status.step_p99_ms for name, status in statuses.items() if status is not None},
            "share": (self._cpu_s() - cpu_s) / seconds,
        }
        self.windows.append(window)
        self._begun = None
        self.end_view()
        return "measured" if len(self.windows) == 2 * _PAIRS else ""

    def end_view(self) -> None:
        """Whoever looks, looks no more."""
        if self._browser is not None:
            self._browser.close()
        if self._view is not None:
            self._view.__exit__()
        self._browser = self._view = None

    def _is_seen(self) -> bool:
        return len(self.windows) % 2 == 0

    def _looks(self) -> bool:
        """Whether there is a view and a browser that looks at it; what is missing is started."""
        if self._view is None:
            self._view = ViewProcess(self._namespace, 0, self._log)
        elif self._browser is None and (url := self._view.url()) != "":
            self._browser = _Browser(url)
        return self._browser is not None and self._browser.received > 0

    def _cpu_s(self) -> float:
        """What the view has used by now [s]; 0 without one."""
        if self._view is None:
            return 0.0
        words = Path(f"/proc/{self._view.pid}/stat").read_text().rsplit(")", 1)[1].split()
        return (int(words[11]) + int(words[12])) / _TICKS


class _Browser:
    """Takes what a page sends as a browser does, and draws nothing: that would be the cost of a browser."""

    def __init__(self, url: str):
        self.received = 0
        self._socket = connect(
            url.replace("http", "ws"),
            subprotocols=[Subprotocol(f"viser-v{viser.__version__}")],
            max_size=None,
            compression=None,
        )
        camera = ViewerCameraMessage(
            wxyz=(1.0, 0.0, 0.0, 0.0), position=(1.0, 1.0, 1.0), fov=1.0, near=0.1, far=100.0, image_height=600,
            image_width=800, look_at=(0.0, 0.0, 0.0), up_direction=(0.0, 0.0, 1.0),
        )  # fmt: skip
        self._socket.send(msgspec.msgpack.encode(camera.as_serializable_dict([])))
        self._thread = threading.Thread(target=self._take, daemon=True)
        self._thread.start()

    def close(self) -> None:
        self._socket.close()

    def _take(self) -> None:
        give_way()  # a browser's place is another computer
        try:
            for message in self._socket:
                self.received += len(message)
        except WebSocketException:
            return
