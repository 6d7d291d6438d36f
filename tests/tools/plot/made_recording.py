"""Recordings made for a test: a clip with more in it than was recorded."""

from dataclasses import replace

import numpy as np
import scenes

from surefoot.bus.codec import decode, encode
from surefoot.bus.messages import ProcessStatus, SimTruth, StateEstimate
from surefoot.bus.recording.reader import Recording
from surefoot.bus.recording.writer import DIGEST, RecordingWriter

OFF_M = np.array([0.001, -0.002, 0.003])
"""The estimate is so far from the truth."""


def with_truth(path, name="collapse", terrain_q=(), every=1):
    """The clip with a truth for each estimate, off by a known distance and turned by a known angle about z."""

    def more(item):
        if item.key == "state/estimate" and item.seq % every == 0:
            yield "sim/truth", encode(truth_of(decode(StateEstimate, item.payload), terrain_q))

    return _rewritten(path, name, more)


def truth_of(estimate, terrain_q=()):
    return SimTruth(
        t=estimate.t,
        seq=estimate.seq,
        valid=True,
        p_WB=estimate.p_WB - OFF_M,
        quat_WB=estimate.quat_WB,
        v_WB_W=estimate.v_WB_W,
        q=estimate.q,
        p_WF=estimate.p_WF - OFF_M,
        com_W=estimate.p_WB - OFF_M,
        force_W=estimate.force_W + 1.0,
        terrain_q=np.array(terrain_q, float),
    )


def with_statuses(path, steps_ms, name="stand"):
    """The clip with statuses of the wbc that tell these median step times [ms]."""
    recording = Recording(scenes.path(name))
    status = ProcessStatus(process="wbc", life="RUN", valid=True, overruns=2, step_max_ms=9.0)
    made = [
        replace(
            status,
            seq=seq,
            t=0.1 * seq,
            steps=100 * (seq + 1),
            step_p50_ms=ms,
            step_p99_ms=2 * ms,
            step_max_ms=9.0,
        )
        for seq, ms in enumerate(steps_ms)
    ]
    writer = RecordingWriter(path, recording.about)
    for message in made:
        writer.add_record(("status/wbc", round(1e9 * message.t), message.seq, encode(message)))
    writer.close()
    return path


def _rewritten(path, name, more):
    recording = Recording(scenes.path(name))
    writer = RecordingWriter(path, recording.about)
    for item in recording:
        record = (item.key, item.t_ns, item.seq, item.payload)
        writer.add_record(record, DIGEST) if item.digest else writer.add_record(record)
        for key, payload in more(item):
            writer.add_record((key, item.t_ns, item.seq, payload))
    writer.close()
    return path
