"""The page: one small web server on this machine, its scene and its panel, and the loop that draws."""

from __future__ import annotations

import time
from collections.abc import Callable
from contextlib import redirect_stdout
from io import StringIO
from threading import Event
from typing import TYPE_CHECKING
from urllib.parse import urlsplit

import numpy as np
import viser
from viser.infra import WebsockClientConnection

from surefoot.config.deployment import Deployment
from surefoot.tools.loopback import HOST, NAMES, listen
from surefoot.tools.view.bus_source import BusSource
from surefoot.tools.view.layers import LAYERS
from surefoot.tools.view.panel import Panel
from surefoot.tools.view.playback_controls import PlaybackControls
from surefoot.tools.view.recording_source import RecordingSource
from surefoot.tools.view.source import Source
from surefoot.tools.view.stage import Stage

if TYPE_CHECKING:
    from surefoot.tools.view.scene import Scene

DRAW_HZ = 10.0
"""Pictures a second: enough to follow a step, and a few per cent of a core."""

CORE_SHARE = 0.09
"""Of a core: where pictures of a run would take more, as on a slow machine, there are fewer of them."""

_SLOWEST_S = 1.0  # from picture to picture all the same
_NOBODY_S = 0.25  # from look to look while no browser is there


def check_port(port: int) -> None:
    """See that a port is free before anything is started; 0 is any.

    Raises:
        CallError: it is taken, or is none.
    """
    listen(port).close()


def draw_period_s(used_s: float) -> float:
    """From one picture of a run to the next [s].

    Args:
        used_s: processor time of this process from the last picture to this one [s].
    """
    return min(max(1.0 / DRAW_HZ, used_s / CORE_SHARE), _SLOWEST_S)


def _refuse_strangers(server: viser.ViserServer) -> None:
    """Let no page of another site that is open in the same browser speak to this one: viser asks nobody."""
    sockets = server._websock_server

    async def look_at(client: WebsockClientConnection) -> None:
        connection = sockets._live_connections[client.client_id]
        origin = connection.request.headers.get("Origin") if connection.request is not None else None
        if origin is not None and urlsplit(origin).hostname not in NAMES:
            await connection.close(1008, "this page is for this machine only")

    sockets.on_client_connect(look_at)


def _scene(deployment: Deployment) -> Scene:
    """The scene, whose libraries are loaded only here: the page is served by then, and a browser on its way."""
    from surefoot.tools.view.scene import Scene

    return Scene(deployment)


class Page:
    """What a browser shows of a source.

    Attributes:
        url: where.
        stage: the scene.
    """

    def __init__(self, source: Source, port: int):
        """Serve it.

        Raises:
            CallError: the port is taken.
        """
        check_port(port)
        self._source = source
        with redirect_stdout(StringIO()):  # viser tells the address in a box of its own
            self._server = viser.ViserServer(host=HOST, port=port, label=source.title, verbose=False)
        if port and self._server.get_port() != port:
            self._server.stop()
            check_port(port)
        self.url = f"http://{HOST}:{self._server.get_port()}"
        _refuse_strangers(self._server)
        self._looked_at = Event()
        self._server.on_client_connect(lambda client: self._looked_at.set())
        gui = self._server.gui
        gui.configure_theme(control_width="large", show_logo=False, show_share_button=False)
        self.stage = Stage(self._server, LAYERS)
        self._controls = PlaybackControls(gui, source) if isinstance(source, RecordingSource) else None
        self._panel = Panel(gui, self.stage, source if isinstance(source, BusSource) else None)
        self._deployment: Deployment | None = None
        self._scene: Scene | None = None
        self._focus = np.zeros(3)

    def run(self, due: Callable[[], bool]) -> None:
        """Draw until `due()`; while no browser looks, only what happens is noted.

        What stands still is built before there is a browser: it is ready by the time that one has come up.
        """
        self._follow_deployment()
        used_s = time.process_time()
        while not due():
            begun = time.monotonic()
            if self._controls is not None:
                self._controls.obey()
            self._source.look()
            watched = bool(self._server.get_clients())
            if watched:
                self.draw()
            period = 1.0 / DRAW_HZ if watched else _NOBODY_S
            before_s, used_s = used_s, time.process_time()
            if watched and self._controls is None:  # a run beside it must not feel it
                period = draw_period_s(used_s - before_s)
            rest_s = max(period - (time.monotonic() - begun), 0.005)
            if watched:
                time.sleep(rest_s)
            elif self._looked_at.wait(rest_s):  # a browser has come: what it shows first is not to wait
                self._looked_at.clear()

    def draw(self) -> None:
        """One picture."""
        source = self._source
        self._follow_deployment()
        heard, margin_m = source.heard, None
        with self._server.atomic():
            if self._scene is not None:
                drawing = self._scene.draw(heard, self._panel.hidden)
                self.stage.show(drawing, self._scene.focus(heard) if self._panel.follows else None)
                margin_m = self._scene.margin_m(heard)
            self._panel.write(heard, source.deployment, source.picture, margin_m, self._pace(), source.words)
            if self._controls is not None:
                self._controls.write()

    def close(self) -> None:
        """Serve no more."""
        self._source.close()
        with redirect_stdout(StringIO()):
            self._server.stop()

    def _follow_deployment(self) -> None:
        """Another run has another terrain, and maybe another robot."""
        if self._source.deployment is not self._deployment:
            self._deployment = self._source.deployment
            self.stage.clear()
            self._scene = _scene(self._deployment) if self._deployment is not None else None
            self._server.gui.set_panel_label(self._source.title)

    def _pace(self) -> str:
        source = self._source
        if isinstance(source, RecordingSource):
            return f"played at {source.speed:g} x" if source.playing else "paused"
        picture = source.picture
        return f"real-time factor {picture.real_time_factor(recent=True):.2f}" if picture is not None else ""
