"""Hears a run over the bus and keeps the picture of it."""

from __future__ import annotations

from contextlib import suppress

from surefoot.bus.codec import decode
from surefoot.bus.errors import MessageError
from surefoot.bus.messages import ProcessStatus
from surefoot.bus.session import Session
from surefoot.components.component import Inbox
from surefoot.components.topic_buffer import TopicBuffers
from surefoot.tools.picture import Picture, SupportMargin

_STREAMS = {"hardware": "hw/state", "estimate": "state/estimate", "reference": "fsm/reference"}
"""What the picture has of each: the newest."""


class Observer:
    """Listens for a display or a supervisor.

    As the processes on the monotonic clock do, it keeps to the session that it heard first on each topic: what a
    second publisher says ends no run. Readers that act on a malformed message count and report it; here the last
    good one stays.

    Attributes:
        margin: how the picture's support margin is found; None leaves it open.
    """

    def __init__(self, session: Session, picture: Picture, margin: SupportMargin | None = None):
        """Begin to listen."""
        self._picture, self.margin = picture, margin
        keys = (*_STREAMS.values(), "fsm/event", "operator/command", "operator/tuning")
        self._buffers, self._inbox = TopicBuffers(keys, ""), Inbox(keys)
        self._buffers.connect(session)
        session.subscribe("status/*", self._on_status)

    def look(self) -> None:
        """Take in what has arrived."""
        picture, inbox = self._picture, self._inbox
        self._buffers.deliver_all(inbox)
        for name, key in _STREAMS.items():
            if inbox.new(key):
                setattr(picture, name, inbox.latest(key))
        for event in inbox.new("fsm/event"):
            picture.note_event(event)
        for command in inbox.new("operator/command"):
            picture.note_command(command.command)
        for tuning in inbox.new("operator/tuning"):
            picture.tuned = tuning.assignment
        inbox.clear_new()
        picture.note_time()
        if self.margin is not None and picture.estimate is not None and picture.reference is not None:
            picture.margin_m = self.margin(picture.estimate, picture.reference)

    def _on_status(self, key: str, payload: bytes) -> None:
        with suppress(MessageError):
            self._picture.note_status(decode(ProcessStatus, payload))
