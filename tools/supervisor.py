"""Starts every process of a deployment, watches them by name, restarts one on request, stops them in order."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path

from surefoot.bus.endpoints import check_keys
from surefoot.bus.hub_socket import refuse_second_hub
from surefoot.bus.topics import PROCESSES
from surefoot.config.deployment import Deployment
from surefoot.tools.diagnosis import clock_stands
from surefoot.tools.end_signals import deaf
from surefoot.tools.handovers import Handovers
from surefoot.tools.launcher import Launcher, end_process
from surefoot.tools.lending import Lending
from surefoot.tools.parting import Parting
from surefoot.tools.picture import Picture, Watched
from surefoot.tools.recording.recorder_process import NAME as RECORDER
from surefoot.tools.recording.recorder_process import RecorderProcess
from surefoot.tools.reload.source_watch import SourceWatch
from surefoot.tools.restart_policy import RestartPolicy
from surefoot.tools.restart_queue import RestartQueue
from surefoot.tools.supervisor_desk import SupervisorDesk

ENDED_BY_USER, ENDED_BY_COMMAND = "ended by the user", "stopped by command"

MAX_CRASHES = 3
"""In simulation a process that ends by itself is started again as often as this."""

_LOOK_S = 0.1
_UP_AGAIN_S = 30.0  # a restarted process is given so long before the next one goes, or it once more
# The planner first, the hardware last: what is downstream keeps the robot while its upstream goes.
_STOP_ORDER = ("fsm", "trajopt", "elevation_map", "mpc", "wbc", "estimator", "io")


class Supervisor:
    """Reconciles wanted and running processes of one deployment.

    In simulation a process that ends by itself is started again, and simulated time waits for it. On the
    monotonic clock the run ends: the gate in io damps the robot as soon as commands are missing.

    It starts what `network.hosts` gives this machine; the rest it only hears. The machine of io begins the run.

    Attributes:
        picture: what has been heard, updated while `run` goes on.
    """

    def __init__(
        self,
        config: Path,
        overrides: list[str],
        deployment: Deployment,
        sources: SourceWatch | None = None,
        record: Path | None = None,
        beats: bool = False,
    ):
        """For a deployment.

        Args:
            config: its file.
            overrides: assignments on top of it.
            deployment: what both give.
            sources: restart what is made of them when they change (simulated time only).
            record: the file that a recorder writes, beside the processes.
            beats: be the operator's heartbeat.
        """
        self._run, self._network = deployment.run, deployment.network
        self._simulated = deployment.run.clock == "simulated"
        settings = list(overrides)
        if not self._simulated:
            settings.append(f"run.epoch_s={time.monotonic()!r}")
        self._sources, self._record = sources, record
        self._recorder: RecorderProcess | None = None
        self._clock_stands = False
        self._asked, self._at_once = "", False  # why a person wants it to end, and whether without waiting
        self._goes_on = False
        self.picture = Picture(simulated=self._simulated)
        for name in PROCESSES:
            if name not in self._network.components_here:
                self.picture.processes[name].host = self._network.host_of(name)
        self._launcher = Launcher(config, settings, Path(deployment.run.log_dir))
        self._desk = SupervisorDesk(config, settings, deployment, self.picture, beats)
        self._handovers = Handovers(self.picture, self._launcher, self.note)
        self._policy = RestartPolicy(self.picture, self._handovers)
        self._queue = RestartQueue(self.picture, _UP_AGAIN_S)
        self._parting = Parting(deployment, self.picture, self.command, self.note)
        self._lending = Lending(self.picture, self._desk.answer, self.note)

    def run(self, until: Callable[[Picture], str], each: Callable[[Picture], None] = lambda picture: None) -> str:
        """Start everything; until `until(picture)` gives a reason to end, which is returned.

        A robot that stands on its own time sits down first. Whatever happens, no process is left behind.

        Raises:
            BusError: io did not come up or cannot be reached, another run has this namespace, or this machine's
                keys cannot be used.
        """
        at_hub = self._network.at_hub
        check_keys(self._network)
        if at_hub:
            refuse_second_hub(self._run.namespace)
        try:
            self._launcher.open()
            if at_hub:
                self._start(self.picture.processes["io"])
            self._desk.open(self._launcher)
            self._await_io(each)
            self._start_recorder(each)
            first = self._run.command if at_hub else ""
            if self._simulated:
                self._desk.command(first)
            for name in self._network.components_here:
                if name != "io":
                    self._start(self.picture.processes[name])
            self._goes_on = True
            while True:
                self._look(each)
                # In real time nobody waits: told to stand before its controller is there, a robot is asked for the
                # middle of that motion first, which the gate refuses.
                if not self._simulated and first and self.picture.all_there:
                    self._desk.command(first)
                    first = ""
                reason = self._reconcile() or self._parting.end(until(self.picture) or self._asked)
                if reason or self._at_once:
                    self.picture.ending = reason or self._asked
                    return self.picture.ending
                time.sleep(_LOOK_S)
        finally:
            self.stop()
            self._goes_on = False

    def end(self) -> bool:
        """Have the run end at its next look, or once the robot sits; asked again, at its next look at the latest.

        A signal's handler may call it in the middle of anything. Were an exception raised there, it could leave a
        lock held, such as that by which a `Popen` waits, and the run would never end.

        Returns:
            False: there is no such look, before the run goes on and where it hangs; it has to be broken off.
        """
        if not self._goes_on or self._at_once:
            return False
        self._at_once = self._asked != "" or not self._parting.settles
        self._asked = self._asked or ENDED_BY_USER
        return True

    def stop(self) -> None:
        """End every process in order, by force those that do not; a second Ctrl-C does not break it off."""
        with deaf():
            self.picture.ending = self.picture.ending or "its supervisor was told to stop"
            self._desk.tell()
            self._handovers.end()
            for name in _STOP_ORDER:
                self._end(self.picture.processes[name])
            if self._recorder is not None:
                self._recorder.end()
                self._note_recorder()
            self._desk.close()
            self._launcher.close()

    def restart(self, name: str, why: str = "on request") -> None:
        """Restart one process; what was done, or why not, is noted in the picture.

        On the monotonic clock its successor is started first and takes its place when it is ready.
        """
        if name not in PROCESSES:
            self.note(f"cannot restart {name!r}: there are {', '.join(PROCESSES)}")
        elif refusal := self._policy.refusal(name):
            self.note(f"cannot restart {name}{refusal}")
        elif self._simulated:
            self._start_anew(self.picture.processes[name])
            self.note(f"{name} restarted {why}")
        else:
            self._handovers.begin(self.picture.processes[name])

    def command(self, command: str) -> None:
        """Give the robot a command in the operator's place; a BusError says that the run does not go on."""
        self._desk.command(command)

    def note(self, words: str) -> None:
        """Say something on the display and in the supervisor's log."""
        self.picture.notes.append(words)
        self._launcher.note(f"{self.picture.t:.3f} s  {words}")

    # Start and end --------------------------------------------------------------------------------------

    def _start(self, watched: Watched) -> None:
        watched.popen = self._launcher.launch(watched.name, watched.restarts)

    def _start_again(self, watched: Watched) -> None:
        watched.begin_anew()
        self._start(watched)

    def _start_anew(self, watched: Watched) -> None:
        """End a process, then start it again."""
        self._end(watched)
        self._start_again(watched)

    def _end(self, watched: Watched) -> None:
        """End a process: one of ours by force if need be; one that somebody runs by hand is told to."""
        self._lending.end(watched)
        end_process(watched.popen)

    def _start_recorder(self, each: Callable[[Picture], None]) -> None:
        """Before the other processes: their first messages are to be there too."""
        if self._record is None:
            return
        self._recorder = RecorderProcess(self._record, self._run.namespace, self._launcher.log_of(RECORDER))
        self._launcher.watch(self._recorder.pid, RECORDER)
        while not self._recorder.ready:
            self._look(each)
            time.sleep(_LOOK_S)

    def _await_io(self, each: Callable[[Picture], None]) -> None:
        """Until it has spoken: what is published before its subscriptions stand is lost."""
        io = self.picture.processes["io"]
        while io.status is None and io.exit_code is None:
            self._look(each)
            time.sleep(_LOOK_S)

    def _look(self, each: Callable[[Picture], None]) -> None:
        """Hear what is new, tell what this supervisor knows, show both."""
        self._desk.look()
        words = clock_stands(self.picture)
        if words and not self._clock_stands:
            self.note(words)  # of a short pause nothing else would be left to read
        self._clock_stands = words != ""
        each(self.picture)

    # Reconcile ------------------------------------------------------------------------------------------

    def _reconcile(self) -> str:
        """Obey requests; start again what ended; a reason to end the run at once, or ""."""
        for request in self._desk.requests():
            if not self._asked:  # a run that is to end begins nothing
                self._obey(request)
        self._settle_handovers()
        if reason := self._bury() or self._take_back():
            return reason
        self._note_recorder()
        self._reload()
        if (due := self._queue.next()) is not None:
            self.restart(*due)
        return ""

    def _obey(self, request: str) -> None:
        """Do what a person asks."""
        match request.split():
            case ["stop", *_]:
                self._asked = self._asked or ENDED_BY_COMMAND
            case ["restart", name]:
                self._ask_restart(name, "on request")
            case ["lend", name, pid] if pid.isdecimal():
                self._lending.lend(name, int(pid), self._lending_refusal)
            case words:
                self.note(f"not understood: {' '.join(words)[:80]!r}")

    def _lending_refusal(self, name: str) -> str:
        return self._policy.refusal(name) if name in PROCESSES else f": there are {', '.join(PROCESSES)}"

    def _ask_restart(self, name: str, why: str) -> None:
        """Restart a process as soon as those asked for before it are up again."""
        if name in PROCESSES and not self._policy.refusal(name):
            if words := self._queue.add(name, why):
                self.note(words)
        else:
            self.restart(name, why)  # says why not

    def _settle_handovers(self) -> None:
        """A successor that failed: its predecessor goes on, if the robot cannot be without it for a while."""
        for name, obituary in self._handovers.settle():
            if self._policy.can_spare(name):
                self._start_anew(self.picture.processes[name])
                self.note(f"{name} restarted on request, without its memory; {obituary}")
            else:
                self.note(f"{name} goes on as it was: its successor failed; {obituary}")

    def _bury(self) -> str:
        """Start again what has ended by itself; a reason to end the run, or ""."""
        for watched in self.picture.processes.values():
            code = watched.exit_code
            if code is None:
                continue
            what = self._launcher.obituary(watched.name, code)
            if code == 0 and self._simulated and not self._network.at_hub:
                return f"the run on {self._network.hub} has ended"  # its clock has told the processes to end
            if self._sources is not None and watched.name != "io" and code > 0:
                # The same source would end in the same way.
                watched.popen = None
                watched.out = f"{what.removeprefix(watched.name).strip()}; it waits for its source to change"
                self.note(f"{watched.name} {watched.out}")
                continue
            if watched.name == "io" or not self._simulated:
                if reason := self._parting.lost(watched.name, what):
                    return reason
                continue
            watched.crashes += 1
            if watched.crashes > MAX_CRASHES:
                return f"{what}; it had been restarted {MAX_CRASHES} times"
            self._start_again(watched)
            self.note(f"{what}; restarted, {watched.crashes} of {MAX_CRASHES}")
        return ""

    def _take_back(self) -> str:
        """Run again what was lent to a process that has ended; a reason to end the run, or ""."""
        for watched, pid in self._lending.returned():
            if refusal := self._policy.refusal(watched.name):
                return f"process {pid}, which had {watched.name}, has ended{refusal}"
            self._start_again(watched)
            self.note(f"process {pid} has ended: {watched.name} is started again here")
        return ""

    def _note_recorder(self) -> None:
        """Say how the recorder has ended."""
        if self._recorder is not None and (words := self._recorder.obituary()):
            self._recorder = None
            self.note(words)

    def _reload(self) -> None:
        """Restart what is made of sources that have changed."""
        change = self._sources.changed() if self._sources is not None else None
        if change is None:
            return
        for words in change.notes:
            self.note(words)
        for name in change.processes:
            self._ask_restart(name, f"after a change of {change.what}")
