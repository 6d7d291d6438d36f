"""`surefoot run`: the supervisor with a status on the terminal and a summary at the end."""

from __future__ import annotations

import sys
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from pathlib import Path

from rich.console import Console, Group

from surefoot.bus.topics import PROCESSES
from surefoot.components.real_time import refusal
from surefoot.config.deployment import Deployment, load_deployment
from surefoot.tools.commands.call import CallError
from surefoot.tools.commands.view import check_view
from surefoot.tools.doctor.check import failures
from surefoot.tools.doctor.examination import examine_robot
from surefoot.tools.doctor.report import as_lines
from surefoot.tools.end_signals import heed
from surefoot.tools.picture import Picture
from surefoot.tools.recording.recorder import check_space
from surefoot.tools.reload.source_watch import SourceWatch
from surefoot.tools.run_display import StatusLines, StatusScreen, print_summary
from surefoot.tools.solve_time import light_profile_reason
from surefoot.tools.startup.dialog import Dialog
from surefoot.tools.startup.readiness import Readiness
from surefoot.tools.status_screen import screen
from surefoot.tools.supervisor import ENDED_BY_COMMAND, ENDED_BY_USER, Supervisor
from surefoot.tools.verdict import Verdict, verdict
from surefoot.tools.view.view_process import ViewProcess


@dataclass(frozen=True)
class RunCall:
    """What a person asks of a run.

    Attributes:
        config: the deployment's file.
        overrides: assignments `section.key=value`.
        seconds: end after this much of the run's time; 0 no limit.
        plain: lines even where there is a terminal.
        reload: restart the processes whose source changes.
        record: write everything to this file.
        beats: the operator is at this terminal: be the heartbeat that the deployment may ask for.
        view: port of a page that shows the run; 0 any that is free, None there is no page.
    """

    config: Path
    overrides: tuple[str, ...] = ()
    seconds: float = 0.0
    plain: bool = False
    reload: bool = False
    record: Path | None = None
    beats: bool = False
    view: int | None = None


def live_run(call: RunCall) -> int:
    """Run a deployment until it is over or the user ends it.

    Returns:
        0 the goal was reached, or it was ended in time or by the user; 1 it failed.

    Raises:
        CallError: `reload` in real time; no view can be shown.
        RecordingError: there is no folder for the recording.
    """
    console = Console(soft_wrap=True)
    deployment = _checked(call)
    interactive = console.is_terminal and not call.plain
    guided = interactive and _is_guided(deployment)
    if guided and not _is_sound(deployment):
        return 1
    beats = call.beats or guided  # whoever answers the questions is there
    overrides, note = list(call.overrides), ""
    if _profile_is_open(deployment, overrides):
        console.print("measuring how long a solve of the MPC takes here")
        note = light_profile_reason(deployment)
        if note:
            overrides.append("mpc.profile=light")
            deployment = load_deployment(call.config, overrides)
    watch = SourceWatch() if call.reload else None
    supervisor = Supervisor(call.config, overrides, deployment, watch, call.record, beats)
    warning = check_space(call.record) if call.record is not None else ""
    for told in filter(None, (warning, note, _refused_priority(deployment))):
        supervisor.note(told)
    title = _title(call.config.name, deployment)
    console.print(f"{title}; logs in {deployment.run.log_dir}/; Ctrl-C ends the run")
    if deployment.operator.heartbeat_s and not beats:
        console.print("the robot asks for the operator's heartbeat: surefoot heartbeat, or run with --beat")
    heed(supervisor.end)
    dialog = _dialog(deployment, console, supervisor) if guided else None
    on_screen = title if interactive else ""
    with _view(deployment, call.view) as view:
        reason, state = _supervised(supervisor, deployment, call.seconds, on_screen, dialog, console, view)
    supervisor.note(f"{reason}. {state.advice}")
    print_summary(console, supervisor.picture, reason, state, deployment.run.log_dir)
    return 0 if state.good else 1


def _checked(call: RunCall) -> Deployment:
    """The deployment that is asked for; what cannot be done is told before anything is started."""
    deployment = load_deployment(call.config, call.overrides)
    if deployment.network.at_hub:
        deployment.load_unit()  # io's
    if call.reload and deployment.run.clock != "simulated":
        raise CallError(
            "--reload needs run.clock = 'simulated': in real time nothing waits for a process that is restarted"
        )
    if call.record is not None and not deployment.network.at_hub:
        raise CallError(f"--record is for {deployment.network.hub}, the machine of io: all journals meet there")
    if call.view is not None:
        check_view(call.view)
        if not deployment.network.at_hub:
            raise CallError(
                f"--view is for {deployment.network.hub}, the machine of io; here: surefoot view --connect"
            )
    return deployment


def _refused_priority(deployment: Deployment) -> str:
    """Why the control chain has to go without real-time priority; empty where it has it, or none is asked."""
    run, most_urgent = deployment.run, max(process.urgency for process in PROCESSES.values())
    asked = run.clock == "monotonic" and run.realtime_priority > 0
    return refusal(run.realtime_priority + most_urgent) if asked else ""


def _view(deployment: Deployment, port: int | None) -> AbstractContextManager[ViewProcess | None]:
    if port is None:
        return nullcontext()
    return ViewProcess(deployment.run.namespace, port, Path(deployment.run.log_dir) / "view.log")


def _title(name: str, deployment: Deployment) -> str:
    where = f" on {deployment.network.here}" if len(deployment.network.hosts) > 1 else ""
    dry = ", DRY RUN" if deployment.hw.dry_run else ""
    return f"Surefoot, {name}{where}, {deployment.run.clock} clock, mpc {deployment.mpc.profile}{dry}"


def _supervised(
    supervisor: Supervisor,
    deployment: Deployment,
    seconds: float,
    title: str,
    dialog: Dialog | None,
    console: Console,
    view: ViewProcess | None,
) -> tuple[str, Verdict]:
    """Run until it is over: why, and what that means. A `title` is that of the screen; "": line by line."""
    state = Verdict()

    def until(picture: Picture) -> str:
        nonlocal state
        if view is not None and (news := view.news()):
            supervisor.note(news)
        if not state.over:  # the robot that sits down before the end has nothing more to say to it
            state = verdict(picture, deployment.terrain.kind, seconds, bool(title))
        return state.reason if state.over else ""

    def drawn(picture: Picture) -> Group:
        closing = f"{state.reason}. {state.advice}" if state.reason else ""
        return screen(picture, deployment.fsm.alternatives, title, closing)

    try:
        if title:
            with StatusScreen(drawn, dialog) as shown:
                reason = supervisor.run(until, shown)
        else:
            reason = supervisor.run(until, StatusLines(console))
    except KeyboardInterrupt:
        reason = ENDED_BY_USER
    if reason in (ENDED_BY_USER, ENDED_BY_COMMAND) and not state.over:
        state = Verdict(reason, over=True, good=True)
    return reason, state


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
