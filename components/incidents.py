"""What went wrong once with messages, and is told for a while."""

from __future__ import annotations

from threading import Lock

from surefoot.bus.topics import TOLD_S


class Incidents:
    """Of each key the newest, told for `TOLD_S` of the run's time; any thread may note one."""

    def __init__(self) -> None:
        self._lock = Lock()
        self._new: dict[str, str] = {}
        self._told: dict[str, tuple[float, str]] = {}  # words, and the time at which they were told first [s]

    def note(self, key: str, words: str) -> None:
        """Something went wrong on a key, or with what goes by another name."""
        with self._lock:
            self._new.pop(key, None)
            self._new[key] = words

    def words(self, t: float) -> str:
        """What is to be told at time `t` [s] of the run, the newest first; empty when all is well again."""
        with self._lock:
            new, self._new = self._new, {}
        kept = {key: told for key, told in self._told.items() if key not in new and t - told[0] <= TOLD_S}
        self._told = kept | {key: (t, words) for key, words in new.items()}
        return "; ".join(words for _, words in reversed(self._told.values()))
