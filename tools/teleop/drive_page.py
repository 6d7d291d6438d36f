"""`surefoot drive --browser`: one page on this machine, from which a person drives."""

from __future__ import annotations

import json
import logging
import time
from collections.abc import Callable
from http import HTTPStatus
from pathlib import Path
from threading import Event, Lock, Thread
from typing import Any
from urllib.parse import urlsplit

from websockets.exceptions import ConnectionClosed
from websockets.frames import CloseCode
from websockets.http11 import Request, Response
from websockets.sync.server import ServerConnection, serve

from surefoot.bus.session import Session
from surefoot.components.deployment_desk import ask_deployment
from surefoot.components.fsm.words import PAUSED
from surefoot.config.operator import Operator
from surefoot.config.robot import LEGS
from surefoot.config.typed_toml import build
from surefoot.tools.diagnosis import why_nothing_moves
from surefoot.tools.loopback import HOST, NAMES, listen
from surefoot.tools.stack_watch import StackWatch
from surefoot.tools.teleop.driver import Driver
from surefoot.tools.teleop.gamepad import TABLE, Gamepad
from surefoot.tools.teleop.keys import ARROWS, KEYS, LEAVE, SURE
from surefoot.tools.teleop.remote import Remote

SILENT_S = 1.5
"""A page that is not heard for so long is gone: it hangs, or its link is lost."""

_SIGN_S = 0.1  # from one sign of life of the page to the next
_DRAW_S = 0.2
_ANSWERS = 3
_HANDOVER_S = 0.5  # a page that is loaded anew comes while its former self is leaving
_PARTING_S = 1.0  # that a page which is told to go may take
_LONGEST = 4096  # bytes of what a page says
_SOCKET = "/drive"
_PAGE = Path(__file__).with_name("drive_page.html")
_HEADERS = {
    "Content-Type": "text/html; charset=utf-8",
    "Cache-Control": "no-store",
    # It asks nobody else for anything, and no other page may show it in a frame and lead a hand to its buttons.
    "Content-Security-Policy": "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; "
    "connect-src 'self'; img-src data:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
}
_LOG = logging.getLogger(__name__)
_LOG.addFilter(lambda record: record.msg != "opening handshake failed")  # browsers knock and then ask for nothing


class DrivePage:
    """Serves the page, and obeys the one browser that drives.

    The page says ten times a second how the gamepad is held: that is its sign of life, and a beat where the run
    asks for a heartbeat. A page that is gone, whatever the reason, beats no more, and a walk that its stick led
    is halted.

    Attributes:
        url: where.
        ended: why the stack is no longer there; empty while it is.
    """

    def __init__(self, connect: Callable[[], Session], port: int, silent_s: float = SILENT_S):
        """Serve it.

        Args:
            connect: opens the bus.
            port: on this machine; 0 any that is free.
            silent_s: how long a page may say nothing; half the heartbeat's time at the most [s].

        Raises:
            CallError: the port is taken, or is none.
            BusError: no stack runs there.
        """
        listener = listen(port)
        self._session = connect()
        self._watch = StackWatch(connect)
        self._remote = Remote(self._session, beats=False)
        operator = build(Operator, ask_deployment(self._session).get("operator", {}), "operator")
        self._heartbeat_s = operator.heartbeat_s
        # A halt for a page that is gone comes before the heartbeat is missed: the robot sits last.
        self._silent_s = min(silent_s, operator.heartbeat_s / 2.0) if operator.heartbeat_s else silent_s
        self._seat, self._over = Lock(), Event()
        self._server = serve(
            self._seat_driver,
            sock=listener,
            process_request=_answer,
            compression=None,
            ping_interval=None,  # a browser answers pings for a page that hangs
            close_timeout=_PARTING_S,
            max_size=_LONGEST,
            logger=_LOG,
        )
        self.url = f"http://{HOST}:{listener.getsockname()[1]}"

    @property
    def ended(self) -> str:
        """Of the watch."""
        return self._watch.ended

    def run(self, due: Callable[[], bool]) -> None:
        """Serve until `due()`, or until the stack ends."""
        Thread(target=self._server.serve_forever, daemon=True).start()
        while not (due() or self.ended):
            self._watch.look()
            time.sleep(_DRAW_S / 2.0)

    def close(self) -> None:
        """Serve no more; who drives is unseated first."""
        self._over.set()
        self._server.shutdown()
        with self._seat:
            self._watch.close()
            self._session.close()

    def _seat_driver(self, connection: ServerConnection) -> None:
        """One page, in a thread of its own."""
        if not self._seat.acquire(timeout=_HANDOVER_S):
            connection.close(CloseCode.TRY_AGAIN_LATER, "another page drives this robot")
            return
        driver = Driver(self._remote.ask, lambda: self._state == ("STOPPED", PAUSED))
        gamepad = Gamepad(driver)
        try:
            code, why = self._obey(connection, driver, gamepad)
        except ConnectionClosed:
            return
        finally:
            if gamepad.leads:
                self._remote.halt()
            self._seat.release()
        connection.close(code, why)

    def _obey(self, connection: ServerConnection, driver: Driver, gamepad: Gamepad) -> tuple[CloseCode, str]:
        """Do what the page says, until it is over; with what the page is told then."""
        connection.send(json.dumps(self._first_words()))
        told = 0.0
        while not (driver.leaves or self._over.is_set()):
            try:
                said = json.loads(connection.recv(timeout=self._silent_s))
            except TimeoutError:
                return CloseCode.GOING_AWAY, f"the page was not heard for {self._silent_s:g} s"
            if self._heartbeat_s:
                self._remote.beat()
            if key := said.get("key"):
                gamepad.give_way(ARROWS.get(key, key))
                driver.press(key)
            if pad := said.get("pad"):
                gamepad.feel(pad["stick"], pad["down"])
            else:
                gamepad.let_go()
            if time.monotonic() - told > _DRAW_S:
                told = time.monotonic()
                connection.send(json.dumps(self._news(driver)))
        if driver.leaves:
            return CloseCode.NORMAL_CLOSURE, "you have left"
        return CloseCode.GOING_AWAY, self.ended or "surefoot drive was ended"

    @property
    def _state(self) -> tuple[str, str]:
        reference = self._watch.picture.reference
        return (reference.state, reference.reason) if reference is not None else ("", "")

    def _first_words(self) -> dict[str, Any]:
        """What the page has to know: numbers and tables stand on this side alone."""
        sits = f"It is the heartbeat that the robot asks for: {self._heartbeat_s:g} s later the robot sits down."
        goes_on = "The robot goes on, but for a walk that the stick leads: it halts."
        return {
            "where": self._watch.where,
            "rule": sits if self._heartbeat_s else goes_on,
            "keys": [[key, each.label] for key, each in KEYS.items()],
            "more": [*ARROWS, SURE, LEAVE],
            "sure": SURE,
            "pad": TABLE,
            "every_ms": 1e3 * _SIGN_S,
        }

    def _news(self, driver: Driver) -> dict[str, Any]:
        state, reason = self._state
        picture = self._watch.picture
        leg = picture.reference.leg if picture.reference is not None else -1
        return {
            "state": state or "the state machine has not spoken yet",
            "reason": f"leg {LEGS[leg]}, {reason}" if leg >= 0 else reason,
            "why": why_nothing_moves(picture),
            "question": driver.question,
            "said": [[words, each and each.taken, each and each.words] for words, each in driver.said[-_ANSWERS:]],
        }


def _answer(connection: ServerConnection, request: Request) -> Response | None:
    """The page, or the way to its socket; neither for another site's page that is open in the same browser.

    A name that is made to lead here (DNS rebinding) stands in Host, another page's in Origin.
    """
    host = request.headers.get("Host", "")
    if urlsplit(f"//{host}").hostname not in NAMES:
        return connection.respond(HTTPStatus.FORBIDDEN, f"this page is for this machine only: http://{HOST}\n")
    if request.path == _SOCKET:
        own = request.headers.get("Origin") == f"http://{host}"
        return None if own else connection.respond(HTTPStatus.FORBIDDEN, "only the page itself may drive\n")
    if request.path != "/":
        return connection.respond(HTTPStatus.NOT_FOUND, "there is one page, /\n")
    response = connection.respond(HTTPStatus.OK, _PAGE.read_text())
    del response.headers["Content-Type"]  # of plain text
    response.headers.update(_HEADERS)
    return response
