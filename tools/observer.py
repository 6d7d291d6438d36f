"""Hears a run over the bus and keeps the picture of it."""

from __future__ import annotations

from contextlib import suppress

from surefoot.bus.codec import decode
from surefoot.bus.errors import MessageError
from surefoot.bus.messages import (
    FsmEvent,
    HardwareState,
    MotionReference,
    OperatorCommand,
    ProcessStatus,
    StateEstimate,
)
from surefoot.bus.session import Session
from surefoot.tools.picture import Picture, SupportMargin


class Observer:
    """Listens for a display or a supervisor.

    Readers that act on a malformed message count and report it; here the last good one stays.

    Attributes:
        margin: how the picture's support margin is found; None leaves it open.
    """

    def __init__(self, session: Session, picture: Picture, margin: SupportMargin | None = None):
        """Begin to listen."""
        self._picture, self.margin = picture, margin
        self._streams = [
            ("hardware", HardwareState, session.newest("hw/state")),
            ("estimate", StateEstimate, session.newest("state/estimate")),
            ("reference", MotionReference, session.newest("fsm/reference")),
        ]
        session.subscribe("status/*", self._on_status)
        session.subscribe("fsm/event", self._on_event)
        session.subscribe("operator/command", self._on_command)

    def look(self) -> None:
        """Take in the newest of the streams."""
        picture = self._picture
        for name, kind, take in self._streams:
            payload = take()
            if payload is not None:
                with suppress(MessageError):
                    setattr(picture, name, decode(kind, payload))
        picture.note_time()
        if self.margin is not None and picture.estimate is not None and picture.reference is not None:
            picture.margin_m = self.margin(picture.estimate, picture.reference)

    def _on_status(self, key: str, payload: bytes) -> None:
        with suppress(MessageError):
            self._picture.note_status(decode(ProcessStatus, payload))

    def _on_event(self, key: str, payload: bytes) -> None:
        with suppress(MessageError):
            self._picture.note_event(decode(FsmEvent, payload))

    def _on_command(self, key: str, payload: bytes) -> None:
        with suppress(MessageError):
            self._picture.note_command(decode(OperatorCommand, payload).command)
