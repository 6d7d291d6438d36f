"""Wall time of a part of the stack, taken from outside."""

from __future__ import annotations

from array import array
from time import perf_counter
from typing import Any


class Stopwatch:
    """Times every call of one method of an object: the object, and what it sends, know nothing of it.

    Attributes:
        ms: wall time of each call [ms].
    """

    def __init__(self, part: object, method: str):
        self.ms = array("f")
        self._call = getattr(part, method)
        vars(part)[method] = self  # an instance's own attribute goes before its class's method

    def __call__(self, *given: Any) -> Any:
        begun = perf_counter()
        answer = self._call(*given)
        self.ms.append(1e3 * (perf_counter() - begun))
        return answer
