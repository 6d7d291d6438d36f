"""What of a recording is to be drawn."""

from __future__ import annotations

from dataclasses import dataclass

from surefoot.tools.plot.probes import Probe, choose, find_probes
from surefoot.tools.tables.recording_tables import RecordingTables


@dataclass(frozen=True)
class Choice:
    """A leg, a probe, or everything.

    Attributes:
        leg: -1: all legs.
        number: of the probe among those of the leg, from 1; 0: not chosen.
    """

    leg: int = -1
    number: int = 0

    def probes(self, recording: RecordingTables) -> list[Probe]:
        """Those that are chosen.

        Raises:
            NotRecorded: there is none; the message lists what there is.
        """
        return choose(find_probes(recording), self.leg, self.number)
