"""`surefoot run`: the supervisor with a status on the terminal and a summary at the end."""

from __future__ import annotations

import re
import sys
import time
from collections.abc import Callable
from pathlib import Path

from rich.console import Console, Group
from rich.live import Live

from surefoot.config.deployment import Deployment, load_deployment
from surefoot.tools.commands.call import CallError
from surefoot.tools.diagnosis import why_nothing_moves
from surefoot.tools.doctor.check import failures
from surefoot.tools.doctor.examination import examine_robot
from surefoot.tools.doctor.report import as_lines
from surefoot.tools.end_signals import heed
from surefoot.tools.picture import Picture
from surefoot.tools.recording.recorder import check_space
from surefoot.tools.reload.source_watch import SourceWatch
from surefoot.tools.solve_time import light_profile_reason
from surefoot.tools.startup.dialog import Dialog
from surefoot.tools.startup.keyboard import Keyboard
from surefoot.tools.startup.readiness import Readiness
from surefoot.tools.status_screen import TOLD, event_line, process_table, screen
from surefoot.tools.supervisor import Supervisor
from surefoot.tools.verdict import Verdict, verdict

_DRAW_S = 0.2
_LINE_S = 10.0
_WHY_S = 3.0


def live_run(
    config: Path,
    overrides: list[str],
    seconds: float,
    plain: bool,
    reload: bool = False,
    record: Path | None = None,
    beats: bool = False,
) -> int:
    """Run a deployment until it is over or the user ends it.

    Args:
        config: its file.
        overrides: assignments `section.key=value`.
        seconds: end after this much of the run's time; 0 no limit.
        plain: lines even where there is a terminal.
        reload: restart the processes whose source changes.
        record: write everything to this file.
        beats: the operator is at this terminal: be the heartbeat that the deployment may ask for.

    Returns:
        0 the goal was reached, or it was ended in time or by the user; 1 it failed.

    Raises:
        CallError: `reload` in real time.
        RecordingError: there is no folder for the recording.
    """
    console = Console(soft_wrap=True)
    overrides = list(overrides)
    deployment = load_deployment(config, overrides)
    if deployment.network.at_hub:
        deployment.load_unit()  # io's; a file that cannot be used is told before anything is started
    if reload and deployment.run.clock != "simulated":
        raise CallError(
            "--reload needs run.clock = 'simulated': in real time nothing waits for a process that is restarted"
        )
    if record is not None and not deployment.network.at_hub:
        raise CallError(f"--record is for {deployment.network.hub}, the machine of io: all journals meet there")
    interactive = console.is_terminal and not plain
    guided = interactive and _is_guided(deployment)
    if guided and not _is_sound(deployment):
        return 1
    note = ""
    if _profile_is_open(deployment, overrides):
        console.print("measuring how long a solve of the MPC takes here")
        note = light_profile_reason(deployment)
        if note:
            overrides.append("mpc.profile=light")
            deployment = load_deployment(config, overrides)
    supervisor = Supervisor(config, overrides, deployment, SourceWatch() if reload else None, record, beats)
    warning = check_space(record) if record is not None else ""
    if warning:
        supervisor.note(warning)
    if note:
        supervisor.note(note)
    where = f" on {deployment.network.here}" if len(deployment.network.hosts) > 1 else ""
    title = f"Surefoot, {config.name}{where}, {deployment.run.clock} clock, mpc {deployment.mpc.profile}"
    if deployment.hw.dry_run:
        title += ", DRY RUN"
    state = Verdict()

    def until(picture: Picture) -> str:
        nonlocal state
        state = verdict(picture, deployment.terrain.kind, seconds, interactive)
        return state.reason if state.over else ""

    console.print(f"{title}; logs in {deployment.run.log_dir}/; Ctrl-C ends the run")
    if deployment.operator.heartbeat_s and not beats:
        console.print("the robot asks for the operator's heartbeat: surefoot heartbeat, or run with --beat")
    heed()
    try:
        if interactive:

            def drawn(picture: Picture) -> Group:
                closing = f"{state.reason}. {state.advice}" if state.reason else ""
                return screen(picture, deployment.fsm.alternatives, title, closing)

            dialog = _dialog(deployment, console, supervisor) if guided else None
            with _Screen(drawn, dialog) as shown:
                reason = supervisor.run(until, shown)
        else:
            reason = supervisor.run(until, _Lines(console))
    except KeyboardInterrupt:
        reason, state = "ended by the user", Verdict("ended by the user", over=True, good=True)
    if reason == "stopped by command":
        state = Verdict(reason, over=True, good=True)
    supervisor.note(f"{reason}. {state.advice}")
    _summary(console, supervisor.picture, reason, state, deployment)
    return 0 if state.good else 1


def _profile_is_open(deployment: Deployment, overrides: list[str]) -> bool:
    """In real time a solve must fit the MPC's machine, if nobody has said which profile it is to be."""
    if "mpc" not in deployment.network.components_here:
        return False
    said = any(override.startswith("mpc.profile=") for override in overrides)
    return deployment.run.clock == "monotonic" and deployment.mpc.profile == "paper" and not said


def _is_guided(deployment: Deployment) -> bool:
    """A real robot that waits for a command, and a person who can answer."""
    waits = deployment.hw.backend == "aliengo" and not deployment.run.command and deployment.network.at_hub
    return waits and sys.stdin.isatty()


def _is_sound(deployment: Deployment) -> bool:
    """Whether nothing speaks against starting the robot; says what does."""
    say = Console(soft_wrap=True, highlight=False).print
    findings = examine_robot(deployment, say)
    say(*as_lines(findings), sep="\n")
    if wrong := failures(findings):
        say(f"not started: {', '.join(finding.check for finding in wrong)}; with --plain it is started damped")
    return not wrong


def _dialog(deployment: Deployment, console: Console, supervisor: Supervisor) -> Dialog:
    def say(words: str) -> None:
        console.print(words, markup=False, highlight=False)

    return Dialog(Readiness(deployment.load_robot(), deployment.doctor), say, supervisor.command)


class _Screen:
    """The status on the whole screen; before that, line by line, the dialog of a guided start-up."""

    def __init__(self, drawn: Callable[[Picture], Group], dialog: Dialog | None):
        self._drawn, self._dialog = drawn, dialog
        self._keyboard = Keyboard(sys.stdin.fileno()) if dialog is not None else None
        # The screen wraps long lines; the console that prints on leaves that to the terminal.
        self._live = Live(console=Console(), screen=True, auto_refresh=False)
        self._last = 0.0

    def __enter__(self) -> _Screen:
        return self

    def __exit__(self, *_: object) -> None:
        self._live.stop()

    def __call__(self, picture: Picture) -> None:
        if self._dialog is not None and self._keyboard is not None and not self._dialog.over:
            self._dialog.look(picture, self._keyboard.line())
            return
        now = time.monotonic()
        if now - self._last >= _DRAW_S:
            self._last = now
            self._live.start()
            self._live.update(self._drawn(picture), refresh=True)


class _Lines:
    """The status as lines, for a terminal that is none."""

    def __init__(self, console: Console):
        self._console = console
        self._events = self._notes = 0
        self._last = time.monotonic()
        self._said: dict[str, str] = {}
        self._why = self._why_said = ""
        self._why_since = 0.0

    def __call__(self, picture: Picture) -> None:
        say = self._console.print
        events, notes = list(picture.events), list(picture.notes)
        for event in events[self._events :]:
            if event.kind in TOLD:
                say(event_line(event), markup=False, highlight=False)
        for note in notes[self._notes :]:
            say(f"supervisor: {note}", markup=False, highlight=False)
        self._events, self._notes = len(events), len(notes)
        self._health(picture)
        self._why_nothing_moves(picture)
        now = time.monotonic()
        if picture.reference is not None and now - self._last >= _LINE_S:
            self._last = now
            say(
                f"{picture.t:8.2f} s  {picture.reference.state}, real-time factor "
                f"{picture.real_time_factor(recent=True):.2f}, {picture.counts['accepted']} footholds",
                highlight=False,
            )

    def _why_nothing_moves(self, picture: Picture) -> None:
        """The sentence when it has stood for a while and is another than the last."""
        why = why_nothing_moves(picture)
        words = re.sub(r"[\d.]+", "#", why)
        now = time.monotonic()
        if words != self._why:
            self._why, self._why_since = words, now
        elif why and words != self._why_said and now - self._why_since > _WHY_S:
            self._why_said = words
            self._console.print(f"{picture.t:8.2f} s  nothing moves: {why}", markup=False, highlight=False)
        if not why:
            self._why_said = ""

    def _health(self, picture: Picture) -> None:
        """A process's reason when it changes; a figure that counts up is no change."""
        for name, watched in picture.processes.items():
            reason = watched.status.reason if watched.status is not None else ""
            words = re.sub(r"[\d.]+", "#", reason)
            if words != self._said.get(name, ""):
                self._said[name] = words
                if reason:
                    self._console.print(f"{picture.t:8.2f} s  {name}: {reason}", markup=False, highlight=False)


def _summary(console: Console, picture: Picture, reason: str, state: Verdict, deployment: Deployment) -> None:
    counts, x = picture.counts, picture.estimate.p_WB[0] if picture.estimate is not None else 0.0
    collapses = counts["collapse"] + counts["late_collapse"]
    lines = [
        "",
        reason,
        f"{picture.t:.1f} s of the run's time, real-time factor {picture.real_time_factor():.2f}",
        f"{x:.2f} m forward, {counts['accepted']} footholds accepted, {collapses} collapses, "
        f"{counts['rejected']} candidates out of reach, largest displacement "
        f"{1e3 * picture.displacement_m:.0f} mm, {picture.restarts} restarts",
    ]
    if state.advice:
        lines.append(f"next: {state.advice}")
    lines.append(f"process logs: {deployment.run.log_dir}/")
    if not state.good:
        console.print(process_table(picture))
    console.print("\n".join(lines), markup=False, highlight=False)
