"""Cuts a short recording out of a long one: small enough to be kept beside the tests."""

from __future__ import annotations

from collections.abc import Collection
from pathlib import Path

import numpy as np

from surefoot.bus.codec import decode, encode
from surefoot.bus.errors import RecordingError
from surefoot.bus.recording.reader import Recording
from surefoot.bus.recording.step_log import CHECKPOINT, STEPS, StepLog
from surefoot.bus.recording.writer import DIGEST, RecordingWriter, message_type
from surefoot.bus.topics import PROCESSES
from surefoot.components.registry import component_class
from surefoot.tools.recording.difference import digest
from surefoot.tools.recording.track import LoggedStep, MessageId, Track, load

REMEMBER = tuple(name for name in PROCESSES if component_class(name).remembers)
"""Processes whose state can be recorded: all but the robot's own."""


def cut(
    path: Path,
    out: Path,
    from_t: float,
    until_t: float,
    processes: Collection[str] = REMEMBER,
    digests: Collection[str] = (),
) -> None:
    """Write what a replay of `processes` from `from_t` to `until_t` [s] needs, and nothing else.

    Each process begins at its last recorded state before `from_t`.

    Args:
        path: the long recording, of a run in which no process was restarted.
        out: is overwritten.
        from_t, until_t: what is kept.
        processes: that can be replayed afterwards.
        digests: topics of which eight bytes a message are kept to compare with, not the content: they can be
            read only if their writer is replayed too.

    Raises:
        RecordingError: a process has no recorded state before `from_t`, or was restarted.
    """
    recording = Recording(path)
    material = load(recording, processes, until_t)
    tracks = [_cut_track(path, material.tracks[name], from_t) for name in processes]
    reads = {each for track in tracks for step in track.steps for each in step.reads}
    begins = {
        key: seq
        for track in tracks
        for key, seq in zip(track.checkpoints[0].outputs, track.checkpoints[0].next_seq.tolist(), strict=True)
    }
    writer = RecordingWriter(out, recording.about | {"how": f"clip of {from_t:g} to {until_t:g} s"}, small=True)
    for track in tracks:
        checkpoint = track.checkpoints[0]
        t_ns = round(checkpoint.t * 1e9)
        writer.add_record((f"{CHECKPOINT}/{track.process}", t_ns, 0, encode(checkpoint)))
        if track.steps:
            log = _log(track.steps)
            writer.add_record((f"{STEPS}/{track.process}", round(log.t * 1e9), 0, encode(log)))
    for at, item in material.messages.items():
        published_now = at.seq >= begins.get(at.key, 1 << 62)
        if published_now and at.key in digests:
            message = decode(message_type(at.key), item.payload)
            writer.add_record((item.key, item.t_ns, at.seq, digest(message)), DIGEST)
        elif published_now or at in reads:
            writer.add_record((item.key, item.t_ns, at.seq, item.payload))
    writer.close()


def _cut_track(path: Path, track: Track, from_t: float) -> Track:
    cut_track = track.from_time(from_t)
    if not cut_track.checkpoints:
        raise RecordingError(f"{path}: {track.process} has no recorded state before {from_t:g} s")
    if any(each.boot for each in cut_track.checkpoints):
        raise RecordingError(f"{path}: {track.process} was restarted: clips are cut from undisturbed runs")
    return cut_track


def _log(steps: list[LoggedStep]) -> StepLog:
    inputs = tuple(dict.fromkeys(each.key for step in steps for each in step.reads))
    reads: list[tuple[int, MessageId]] = [(n, each) for n, step in enumerate(steps) for each in step.reads]

    def column(values: list[int]) -> np.ndarray:
        return np.array(values, np.int64)

    return StepLog(
        t=steps[-1].t,
        valid=True,
        process=steps[0].process,
        first_step=steps[0].index,
        release_t=np.array([step.t for step in steps]),
        inputs=inputs,
        read_step=column([n for n, _ in reads]),
        read_input=column([inputs.index(each.key) for _, each in reads]),
        read_boot=column([each.boot for _, each in reads]),
        read_seq=column([each.seq for _, each in reads]),
    )
