"""In words what is the matter with each process, and the one sentence why the robot does not move."""

from __future__ import annotations

import re
import time

from surefoot.bus.messages import ProcessStatus
from surefoot.bus.topics import TOPICS
from surefoot.components.fsm.words import PAUSED, is_direction
from surefoot.tools.picture import Picture, Watched

SILENT_S = 3.0
"""A process tells its status twice a second; one that has not for so long is stopped or hangs."""

CLOCK_STANDS_S = 0.8
"""With the simulated clock io says at least so often that it goes on, or for whom it waits."""

_SLOW = 2
"""So many statuses in a row with a low rate: the first one after a start counts from the run's beginning."""

_AWAITED = re.compile(r"(?:waiting for (\w+) to come up|simulated time waits for (\w+))")
"""What the master of simulated time says of the process it waits for (components/clock_master.py)."""


def why_nothing_moves(picture: Picture, now: float | None = None) -> str:
    """The sentence that names the culprit; empty while the robot moves.

    Args:
        picture: what has been heard.
        now: monotonic clock [s]; the present if left out.
    """
    now = time.monotonic() if now is None else now
    if picture.ending:
        return f"the run ends: {picture.ending}"
    return _of_processes(picture, now) or _of_robot(picture)


def troubles(picture: Picture, now: float | None = None) -> dict[str, str]:
    """What is the matter with each process that is not well, by name; first those that do not work at all."""
    now = time.monotonic() if now is None else now
    still = awaited(picture) != ""  # while time stands still nobody steps
    absent, ailing = {}, {}
    for name, watched in picture.processes.items():
        status = watched.status
        words = clock_stands(picture, now) if name == "io" else ""
        if words := words.removeprefix("io ") or _absence(watched, now):
            absent[name] = words
        elif status is not None:
            parts = [
                status.reason,
                *(f"{each} is too old" for each in _stale(status)),
                _estranged(picture, status),
            ]
            if watched.slow >= _SLOW and not still:
                parts.append(f"makes {status.rate_hz:.0f} of {status.nominal_hz:.0f} steps a second")
            if words := "; ".join(part for part in parts if part):
                ailing[name] = words
    return absent | ailing


def awaited(picture: Picture) -> str:
    """The process that simulated time waits for; empty while it goes on, and on the monotonic clock."""
    status = picture.processes["io"].status
    match = _AWAITED.search(status.reason) if status is not None else None
    return (match[1] or match[2]) if match else ""


def clock_stands(picture: Picture, now: float | None = None) -> str:
    """In words that simulated time stands still because io does, and not for another process; or empty.

    Args:
        picture: what has been heard.
        now: monotonic clock [s]; the present if left out.
    """
    now = time.monotonic() if now is None else now
    io = picture.processes["io"]
    if not picture.simulated or io.status is None or min(now - io.heard, picture.stood_s(now)) < CLOCK_STANDS_S:
        return ""
    what = f"process {io.status.pid} stopped" + (f", or the link to {io.host} down" if io.host else "")
    return f"io has not advanced the clock for {picture.stood_s(now):.1f} s: is {what}?"


def worst_input(status: ProcessStatus) -> tuple[str, float, float] | None:
    """The input that is oldest for what its topic allows: its key, its age and that limit [s]."""
    ages = [each for each in _ages(status) if each[1] >= 0.0]
    return max(ages, key=lambda each: each[1] / each[2], default=None)


def _ages(status: ProcessStatus) -> list[tuple[str, float, float]]:
    """The inputs that have a limit of age: key, age and limit [s].

    A process that steps on events reads its inputs then: they have no age in between.
    """
    return [
        (key, float(age), TOPICS[key].stale_after_s)
        for key, age in zip(status.input, status.input_age_s, strict=False)
        if status.nominal_hz and key in TOPICS and TOPICS[key].stale_after_s
    ]


def _of_processes(picture: Picture, now: float) -> str:
    """Who is not there, or what waits for whom."""
    processes = picture.processes
    if all(watched.status is None for watched in processes.values()):
        out = next((f"{name} {watched.out}" for name, watched in processes.items() if watched.out), "")
        return out or "no process has spoken yet: io comes up first, it opens the bus"
    if words := clock_stands(picture, now):
        return words
    silent = [now - watched.heard for watched in processes.values() if watched.status is not None]
    if min(silent) > SILENT_S:
        return f"nothing on the bus for {min(silent):.0f} s: the link to it or the whole run stands still"
    io = processes["io"]
    if words := _absence(io, now):
        return f"io {words}; it holds the robot and the bus"
    if name := awaited(picture):
        words = _absence(processes[name], now)
        return f"simulated time waits for {name}{f', which {words}' if words else ': its step is not over yet'}"
    # While simulated time goes on it has not come yet to a step of one that is not there.
    if not (picture.simulated and io.status is not None and io.status.steps > 0):
        for name in processes:
            if words := _absence(processes[name], now):
                return f"{name} {words}"
    for name, watched in processes.items():
        if watched.status is not None and watched.status.life == "ACTIVATING":
            culprit, words = _root(picture, name, watched.status.reason)
            return f"{culprit} {words}"
    return ""


def _of_robot(picture: Picture) -> str:
    """All processes are there: the gate, a late input, or a person whose turn it is."""
    reference, hardware = picture.reference, picture.hardware
    late = _late(picture)
    if hardware is not None and hardware.damping:
        wbc = picture.processes["wbc"].status
        damped = reference.reason if reference is not None and reference.state == "DAMP" else ""
        words = [f"the gate in io damps the robot: {hardware.gate}", late or (wbc.reason if wbc else ""), damped]
        return "; ".join(part for part in words if part)
    asked = reference is not None and reference.state == "DAMP" and _as_asked(reference.reason)
    if late and not asked:  # who has nothing to do for a damped robot is not late
        return late
    if reference is None:
        return "fsm has not said yet what the robot is to do"
    if reference.finished:
        return "the robot has reached its goal and waits for a command"
    if reference.state == "DAMP":
        if asked:
            return f"the robot is damped ({reference.reason}): `surefoot command stand` or a direction gets it up"
        return f"the robot is damped: {reference.reason}"
    if reference.state == "HOLD" and picture.command in ("", "hold"):
        return "the robot is held where it lies: `surefoot command stand` gets it up, damp lets it go"
    if reference.state == "STAND" and is_direction(picture.command):
        return ""  # it sets off as soon as it is at its height
    if reference.state == "STAND":
        return "the robot stands and waits for a command: `surefoot command forward` sends it on"
    if reference.state == "STOPPED":
        if reference.reason == PAUSED:
            return "the walk is paused: `surefoot command resume` goes on, `surefoot command step` for one step"
        if reference.reason.startswith("commanded"):
            return f"the robot stands ({reference.reason}): `surefoot command forward` sends it on"
        return f"the robot stopped: {reference.reason}; it waits for a command"
    return ""


def _as_asked(reason: str) -> bool:
    """Whether a robot is damped because a person, or an operator who is gone, has brought that about."""
    return reason in ("waiting for a command", "commanded") or reason.startswith("sitting")


def _absence(watched: Watched, now: float) -> str:
    """In words why a process cannot work; empty if it can."""
    status = watched.status
    silent = watched.silent_s(now)
    if watched.out:
        return watched.out
    if watched.exit_code is not None:
        return "has ended"
    if watched.lent_to and (silent < 0.0 or silent > SILENT_S):
        quiet = f"silent for {silent:.0f} s" if silent >= 0.0 else "has not spoken yet"
        return f"is lent to process {watched.lent_to} and {quiet}: at a breakpoint?"
    if status is None and silent <= SILENT_S:
        return f"has not spoken yet: it comes up{' again' if watched.restarts else ', or is not there'}"
    if status is not None and status.life == "FAILED":
        return f"has failed: {status.reason}"
    if silent > SILENT_S:
        return f"has been silent for {silent:.0f} s: stopped, or hanging in a step"
    return ""


def _root(picture: Picture, name: str, reason: str) -> tuple[str, str]:
    """Who is behind a process that waits for its first inputs: follow the writers to one that waits for nobody."""
    path = [name]
    while True:
        status = picture.processes[path[-1]].status
        if status is None or status.life != "ACTIVATING":
            break
        missing = [key for key, age in zip(status.input, status.input_age_s, strict=False) if age < 0.0]
        writers = [TOPICS[key].writer for key in missing if key in TOPICS and key in status.reason]
        following = next((each for each in writers if each in picture.processes and each not in path), None)
        if following is None:
            break
        path.append(following)
    culprit = path[-1]
    status = picture.processes[culprit].status
    own = status.reason if status is not None else ""
    if len(path) == 1:
        return name, f"waits: {reason or 'it does not say for what'}"
    return culprit, f"is behind it ({own or 'it has published nothing yet'}): " + " waits for ".join(path)


def _stale(status: ProcessStatus) -> list[str]:
    """Inputs that are older than they may be, in words."""
    return [
        f"{key} of {TOPICS[key].writer}, {1e3 * age:.0f} ms, limit {1e3 * limit:.0f} ms"
        for key, age, limit in _ages(status)
        if age > limit
    ]


def _estranged(picture: Picture, status: ProcessStatus) -> str:
    """In words that a process runs with other settings than io; empty while both have the same."""
    io = picture.processes["io"].status
    if io is None or io.settings == status.settings:
        return ""
    return "runs with other settings than io"


def _late(picture: Picture) -> str:
    """The input that is too old, at the process farthest up the stream that has one."""
    late = {}
    for name, watched in picture.processes.items():
        worst = worst_input(watched.status) if watched.status is not None else None
        if worst is not None and worst[1] > worst[2]:
            late[name] = worst
    # One whose writer is late itself only waits; where they wait in a ring, the first is as good as any.
    first = [name for name, (key, *_) in late.items() if TOPICS[key].writer not in late] or list(late)
    for name in first[:1]:
        key, age, limit = late[name]
        writer = TOPICS[key].writer
        status = picture.processes[writer].status if writer in picture.processes else None
        about = f" ({status.reason})" if status is not None and status.reason else ""
        return (
            f"{writer} is late{about}: {name} has its {key} of {1e3 * age:.0f} ms ago, limit {1e3 * limit:.0f} ms"
        )
    return ""
