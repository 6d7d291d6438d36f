"""The supervisor's place on the bus: what it hears of the run and of people, and what it tells them."""

from __future__ import annotations

import os
import queue
import time
from collections.abc import Iterator, Sequence
from pathlib import Path

from surefoot.bus.errors import BusError
from surefoot.bus.service_keys import BEAT, SUPERVISOR_REQUEST
from surefoot.bus.session import Session
from surefoot.components import clock_messages as clock
from surefoot.components.deployment_desk import check_settings
from surefoot.config.deployment import Deployment
from surefoot.tools.launcher import Launcher
from surefoot.tools.observer import Observer
from surefoot.tools.picture import Picture, SupportMargin
from surefoot.tools.supervisor_messages import (
    ANSWER,
    NOTICE,
    Answer,
    Notice,
    Post,
    pack_answer,
    pack_notice,
)

_HUB_S = 60.0
_NOTICE_S = 0.5
_NOTES = 5  # the last ones, in a notice


class SupervisorDesk:
    """Keeps the picture of the run, takes people's requests, publishes the notice and answers."""

    def __init__(
        self,
        config: Path,
        settings: Sequence[str],
        deployment: Deployment,
        picture: Picture,
        beats: bool = False,
    ):
        """Of the supervisor of a deployment.

        Args:
            config: its file.
            settings: assignments on top of it.
            deployment: what both give.
            picture: of the run.
            beats: the operator is at this supervisor's terminal: it is the heartbeat that the robot may ask for.
        """
        self._beat_s = deployment.operator.beat_s if beats else 0.0
        self._beat_due = 0.0
        self._config, self._settings = config, list(settings)
        self._deployment, self._picture = deployment, picture
        self._session: Session | None = None
        self._observer: Observer | None = None
        self._requests: queue.SimpleQueue[str] = queue.SimpleQueue()
        self._notice_due = 0.0

    def open(self, launcher: Launcher) -> None:
        """Join the bus as soon as io holds it, and listen.

        Raises:
            BusError: io has ended, does not open the bus in its time, or runs with other settings than this
                machine is to.
        """
        session = self._session = self._connect(launcher)
        if not self._deployment.network.at_hub:
            check_settings(session, self._deployment, self._deployment.network.here)
        self._observer = Observer(session, self._picture, SupportMargin(self._deployment.load_robot()))
        session.subscribe(SUPERVISOR_REQUEST, lambda key, payload: self.ask(payload.decode(errors="replace")))
        session.serve(NOTICE, lambda: [self._notice()])

    def close(self) -> None:
        """Leave the bus."""
        if self._session is not None:
            self._session.close()
            self._session = None

    def look(self) -> None:
        """Hear what is new, tell what this supervisor knows."""
        if self._observer is not None:
            self._observer.look()
        self._beat()
        if time.monotonic() >= self._notice_due:
            self.tell()

    def tell(self) -> None:
        """Publish the notice."""
        self._notice_due = time.monotonic() + _NOTICE_S
        if self._session is not None:
            self._session.put(NOTICE, self._notice(), lossless=False)

    def ask(self, request: str) -> None:
        """Take in a request."""
        self._requests.put(request)

    def requests(self) -> Iterator[str]:
        """What has been asked, oldest first."""
        while not self._requests.empty():
            yield self._requests.get()

    def answer(self, pid: int, answer: Answer) -> None:
        """Answer the process that asked to be lent one."""
        if self._session is not None:
            self._session.put(f"{ANSWER}/{pid}", pack_answer(answer))

    def command(self, command: str) -> None:
        """Give the robot a command in the operator's place; none where it is empty.

        Raises:
            BusError: the bus is not open.
        """
        if not command:
            return
        if self._session is None:
            raise BusError(f"cannot give the command {command!r}: the bus is open only while `run` goes on")
        self._beat()
        self._session.put(clock.REQUEST, command.encode())

    def _beat(self) -> None:
        now = time.monotonic()
        if self._session is not None and self._beat_s and now >= self._beat_due:
            self._beat_due = now + self._beat_s
            self._session.put(BEAT, b"", lossless=False)

    def _connect(self, launcher: Launcher) -> Session:
        network, namespace = self._deployment.network, self._deployment.run.namespace
        if not network.at_hub:
            return Session(namespace, connect_ms=round(1e3 * _HUB_S), network=network)
        io, end = self._picture.processes["io"], time.monotonic() + _HUB_S
        while True:
            try:
                return Session(namespace, connect_ms=1000, network=network)
            except BusError:
                code = io.exit_code
                if code is not None:
                    raise BusError(launcher.obituary(io.name, code)) from None
                if time.monotonic() > end:
                    raise BusError(
                        f"io did not open the bus in {_HUB_S:.0f} s, see {launcher.log_of('io')}"
                    ) from None

    def _notice(self) -> bytes:
        picture, now = self._picture, time.monotonic()
        posts = {
            name: Post(each.restarts, each.lent_to, each.out, each.silent_s(now))
            for name, each in picture.processes.items()
        }
        return pack_notice(
            Notice(
                pid=os.getpid(),
                config=str(self._config.resolve()),
                settings=self._settings,
                processes=posts,
                notes=picture.notes[-_NOTES:],
                ending=picture.ending,
            )
        )
