"""A recording, at any instant or played at any pace."""

from __future__ import annotations

import time
from bisect import bisect_right
from operator import itemgetter
from pathlib import Path

from surefoot.bus.errors import MessageError, RecordingError
from surefoot.bus.message import Message
from surefoot.bus.messages import FsmEvent
from surefoot.tools.picture import Picture
from surefoot.tools.recording.replay import recorded_deployment
from surefoot.tools.view.heard import STREAMS, Heard
from surefoot.tools.view.history import RARE, History
from surefoot.tools.view.recording_index import RecordingIndex

_VERDICTS = ("collapse", "late_collapse", "accepted", "rejected")
"""Events worth leaping to."""

_AHEAD_S = 10.0  # of the run


class RecordingSource:
    """Time goes on while it plays, and stands where it is put.

    Attributes:
        deployment: as it was recorded.
        heard: at the time `t`.
        playing: time goes on.
        speed: seconds of the run for each second on the wall.
        begin_t, end_t: what there is [s].
        picture: nobody: what processes say of their health is not recorded.
    """

    picture: Picture | None = None

    def __init__(self, path: Path, from_t: float | None = None):
        """Open a recording at a time of its run [s]; the beginning if left out.

        Raises:
            RecordingError: there is no such file, it is no recording, or holds no message of a topic.
            ConfigError: this version does not take its configuration.
        """
        self._index = index = RecordingIndex(path)
        if "state/estimate" not in index.keys and "fsm/reference" not in index.keys:
            raise RecordingError(f"{path}: nothing to be drawn: neither state/estimate nor fsm/reference is in it")
        self.deployment, unknown = recorded_deployment(index.recording)
        self.title = f"Surefoot, {path.name}"
        self.begin_t, self.end_t = index.begin_t, index.end_t
        self._rare: list[tuple[float, Message]] = []
        self._known_t = self.begin_t - _AHEAD_S
        self._notes = [f"{key}: unknown to this version, left out" for key in unknown]
        self._told = 0
        self.heard = Heard()
        self.playing, self.speed = True, 1.0
        self.t = self.begin_t
        self._looked = time.monotonic()
        self.seek(self.begin_t if from_t is None else from_t)

    @property
    def words(self) -> str:
        """What is wrong with the file; empty when nothing is."""
        damage = self._index.damage
        incomplete = [f"the file is incomplete: {damage}; up to its end it can be read"] if damage else []
        return "; ".join(incomplete + self._notes)

    def look(self) -> None:
        """Go on, if it plays."""
        now = time.monotonic()
        if self.playing:
            self.seek(self.t + self.speed * (now - self._looked))
            self.playing = self.t < self.end_t
        self._looked = now

    def seek(self, t: float) -> None:
        """Put time at `t` [s], or at the end that is nearer."""
        self.t = min(max(t, self.begin_t), self.end_t)
        try:
            for name, key in STREAMS.items():
                self.heard.note(name, self._index.newest(key, self.t))
        except (RecordingError, MessageError) as error:
            self._note(error)
        self._tell()

    def leap(self, ahead: bool) -> None:
        """To the next verdict on a foothold, or to the one before."""
        if not ahead:
            for t in [each for each in self._verdicts() if each < self.t][-1:]:
                self.seek(t)
            return
        while not (later := [each for each in self._verdicts() if each > self.t]) and self._known_t < self.end_t:
            self._know(self._known_t)
        for t in later[:1]:
            self.seek(t)

    def close(self) -> None:
        """Nothing is held."""

    def _verdicts(self) -> list[float]:
        """When there was one, of those that are known [s]."""
        return [t for t, each in self._rare if isinstance(each, FsmEvent) and each.kind in _VERDICTS]

    def _know(self, t: float) -> None:
        """Read what is rare until a time [s] and somewhat beyond; the whole of a long file would take a second."""
        if t < self._known_t:
            return
        after_t, self._known_t = self._known_t, t + _AHEAD_S
        try:
            self._rare += self._index.messages(*RARE, after_t=after_t, until_t=self._known_t)
        except MessageError as error:
            self._note(error)

    def _note(self, error: Exception) -> None:
        """Tell it, once."""
        if str(error) not in self._notes:
            self._notes.append(str(error))

    def _tell(self) -> None:
        """The history up to now; time that went back is told anew."""
        self._know(self.t)
        until = bisect_right(self._rare, self.t, key=itemgetter(0))
        if until < self._told:
            self.heard.history, self._told = History(), 0
        for _, message in self._rare[self._told : until]:
            self.heard.history.note(message)
        self._told = until
