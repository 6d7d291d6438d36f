"""How a recorded run ended, judged as a running one is."""

from __future__ import annotations

from surefoot.bus.messages import FsmEvent, HardwareState, MotionReference, OperatorCommand
from surefoot.tools.picture import Picture
from surefoot.tools.tables.recording_tables import RecordingTables
from surefoot.tools.verdict import Verdict, verdict

_LAST_S = 0.1
"""The end of a recording that tells how the run stood."""


def picture_at_the_end(recording: RecordingTables) -> Picture:
    """What a supervisor would have heard of the run by its end."""
    picture = Picture()
    for _, message in recording.messages(("fsm/event", "operator/command")):
        if isinstance(message, FsmEvent):
            picture.note_event(message)
        elif isinstance(message, OperatorCommand):
            picture.note_command(message.word)
    _, end = recording.span_s
    for _, message in recording.messages(("fsm/reference", "hw/state"), end - _LAST_S):
        if isinstance(message, MotionReference):
            picture.reference = message
        elif isinstance(message, HardwareState):
            picture.hardware = message
    return picture


def ending(picture: Picture, terrain: str) -> Verdict:
    """Why it ended, in words; of a recording that ends in the middle of a run, what the robot was doing.

    Args:
        picture: of its end.
        terrain: its kind.
    """
    found = verdict(picture, terrain, 0.0, interactive=False)
    if found.reason:
        return found
    if picture.reference is None:
        return Verdict("nothing of the state machine was recorded at the end")
    said = f": {picture.reference.reason}" if picture.reference.reason else ""
    return Verdict(f"the recording ends while the robot is in {picture.state}{said}")
