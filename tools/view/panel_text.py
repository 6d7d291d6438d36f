"""What stands beside the picture, as small pieces of HTML: no browser is needed to make or to test them."""

from __future__ import annotations

from collections.abc import Iterable
from html import escape

import numpy as np

from surefoot.bus.messages import LegStatus, ProcessStatus
from surefoot.components.fsm.course import AROUND_POINTS
from surefoot.config.deployment import Deployment
from surefoot.config.robot import LEGS
from surefoot.config.tuning import shown, value_of
from surefoot.tools.diagnosis import troubles
from surefoot.tools.picture import RATE_BAND, Picture
from surefoot.tools.status_screen import TOLD, event_line
from surefoot.tools.teleop.tuned_run import TunedRun
from surefoot.tools.view.drawing import Rgb
from surefoot.tools.view.forces import asked_n
from surefoot.tools.view.heard import Heard
from surefoot.tools.view.palette import ASKED, LEG_RGB, LEGEND, MEASURED, VERDICT_RGB, Verdict, candidate_rgb

_EVENTS = 7
_FORCES = 6
_GAUGE_FULL = 1.5  # thresholds across the gauge
_STYLE = "font-size:12px;line-height:1.45;padding:2px 10px 6px"
_DIM, _ALARM, _WARN = "#868e96", "#d62828", "#b35c00"


def machine(heard: Heard, deployment: Deployment, margin_m: float | None, pace: str) -> str:
    """State, leg, candidate, margin and time.

    Args:
        heard: what is known.
        deployment: of the run.
        margin_m: of the support polygon; None while four feet stand [m].
        pace: in words how fast time goes.
    """
    reference = heard.reference
    if reference is None:
        return _block("the state machine has not spoken yet")
    lines = [f"<b style='font-size:16px'>{escape(reference.state)}</b> &nbsp;{escape(reference.reason)}"]
    if reference.leg >= 0:
        number, around, most = reference.candidate, reference.around, deployment.fsm.alternatives
        candidate = f"alternative {number} of {most}" if number else "planned foothold"
        point = f", point {around} of {AROUND_POINTS} around it" if 1 <= around <= AROUND_POINTS else ""
        lines.append(f"leg <b>{LEGS[reference.leg]}</b>, {candidate}{point}")
    if margin_m is not None:
        lifted = reference.leg_status[reference.leg] != LegStatus.STANCE  # before that the fourth foot carries too
        low = lifted and margin_m < deployment.fsm.margin_m
        lines.append(f"support margin {_colored(f'{1e3 * margin_m:.0f} mm', _ALARM if low else '')}")
    lines.append(
        f"t {heard.t:.2f} s, {escape(pace)}"
        + (f"; told: {escape(heard.history.command)}" if heard.history.command else "")
    )
    if heard.hardware is not None and heard.hardware.damping:
        lines.append(_colored(f"the gate damps: {escape(heard.hardware.gate)}", _ALARM))
    return _block("<br>".join(lines))


def press(heard: Heard, deployment: Deployment) -> str:
    """Six bars of the envelope, asked and held, and how far the foot has moved against what is a collapse."""
    reference, history, estimate = heard.reference, heard.history, heard.estimate
    if reference is None or estimate is None or reference.leg < 0:
        return _block(_colored("no leg is moved or probed", _DIM))
    asked = dict(history.press.asked_n)
    if reference.probe_leg >= 0:
        forces = reference.probe_force_W[1 : 1 + _FORCES] @ reference.normal_W
        asked |= {index: float(force) for index, force in enumerate(forces)}
    elif history.plan is not None and not asked:
        asked = {index: float(force) for index, force in enumerate(history.plan.envelope_W @ reference.normal_W)}
    measured = float(estimate.force_W[reference.leg] @ estimate.normal_W)
    most = max([*asked.values(), measured, 1.0])
    rows = []
    for index in range(_FORCES):
        now = index == reference.force_index and index not in history.press.held_n
        held = history.press.held_n.get(index, 0.0)
        rows.append(
            _bar(f"{index + 1}{' ◀' if now else ''}", measured if now else held, asked.get(index, 0.0), most)
        )
    now_n = asked_n(reference)
    told = f"asked {now_n:.0f} N, " if now_n is not None else ""
    rows.append(f"<div>{told}measured {measured:.0f} N</div>")
    return _block("".join(rows) + _gauge(displacement_m(heard), deployment.fsm.collapse_m))


def displacement_m(heard: Heard) -> float | None:
    """How far the probing foot is from where it met the ground [m]; None while it does not stand.

    The drift of the estimate, which the state machine takes off, is in it: a millimetre or two. Where nobody has
    listened at the contact, what the state machine has told last.
    """
    reference, estimate, history = heard.reference, heard.estimate, heard.history
    if reference is None or estimate is None or reference.probe_leg < 0:
        return None
    if history.touch_W is None:
        return history.press.displacement_m
    return float(np.linalg.norm(estimate.p_WF[reference.probe_leg] - history.touch_W))


def feet(heard: Heard) -> str:
    """A row for each foot."""
    estimate, reference, command = heard.estimate, heard.reference, heard.command
    if estimate is None:
        return _block("no estimate yet")
    normal = estimate.normal_W
    rows = []
    for leg, name in enumerate(LEGS):
        status = LegStatus(int(reference.leg_status[leg])) if reference is not None else LegStatus.STANCE
        rows.append(
            (
                f"{_swatch(LEG_RGB[status])} <b>{name}</b> {status.name.lower()}",
                "yes" if estimate.contact[leg] else "-",
                f"{estimate.force_W[leg] @ normal:.0f}",
                "-" if command is None else f"{command.force_W[leg] @ normal:.0f}",
                "-"
                if reference is None or not reference.force_max_n[leg]
                else f"{reference.force_max_n[leg]:.0f}",
            )
        )
    return _block(_table(("foot", "contact", "N", "asked", "cap"), rows))


def candidates(heard: Heard) -> str:
    """What became of each candidate of the leg's turn."""
    history = heard.history
    if not history.candidates:
        return _block(_colored("none yet", _DIM))
    lines = [
        f"{_swatch(candidate_rgb(each.verdict))} <b>{number}</b> "
        + escape(each.outcome or ("on its way" if each.verdict == Verdict.UNTESTED else str(each.verdict)))
        for number, each in sorted(history.candidates.items())
    ]
    return _block(f"leg {LEGS[history.leg]}<br>" + "<br>".join(lines))


def processes(picture: Picture | None) -> str:
    """A row for each process, and what is the matter with it."""
    if picture is None:
        return _block(_colored("a recording does not hold the health of processes", _DIM))
    wrong = troubles(picture)
    rows = []
    for name, watched in picture.processes.items():
        status = watched.status
        if status is None:
            rows.append((name, _colored("absent", _WARN), "", "", ""))
            continue
        life = _colored(status.life, _ALARM if status.life == "FAILED" else _WARN if name in wrong else "")
        figures = f"{status.step_p50_ms:.1f}", f"{status.step_p99_ms:.1f}"
        rows.append((name, life, _rate(status), *figures))
    text = _table(("process", "state", "Hz", "p50 ms", "p99"), rows)
    for name, words in wrong.items():
        text += f"<div style='color:{_WARN}'>{escape(name)}: {escape(words)}</div>"
    return _block(text)


def events(heard: Heard) -> str:
    """The last ones that are worth a line, changes of the settings among them, the newest on top."""
    history = heard.history
    told = [(event.t, event_line(event)) for event in history.events if event.kind in TOLD]
    told += [(each.t, f"{each.t:8.2f} s  tuned: {each.assignment[-1]}") for each in history.tunings]
    newest = sorted(told, key=lambda line: line[0])[-_EVENTS:]
    return _block("<br>".join(escape(line) for _, line in reversed(newest)) or "-")


def changed(run: TunedRun) -> str:
    """What differs from the deployment that a run began with."""
    lines = [
        f"<b>{escape(path)}</b> {shown(value_of(run.now, path))}, was {shown(value_of(run.begun, path))}"
        for path in run.changed
    ]
    return _block("<br>".join(lines) or _colored("as the run began", _DIM))


def legend() -> str:
    """Colours and their meanings."""
    legs = [(rgb, f"foot: {status.name.lower()}") for status, rgb in LEG_RGB.items() if status != LegStatus.SWING]
    rows = "".join(f"<div>{_swatch(rgb)} {escape(meaning)}</div>" for rgb, meaning in (*LEGEND, *legs))
    return _block(f"<div style='columns:2;column-gap:8px'>{rows}</div>")


def alarm(words: str) -> str:
    """Something that a person should read first; nothing where there is nothing."""
    return _block(f"<div style='color:{_ALARM}'><b>{escape(words)}</b></div>") if words else ""


def answer(words: str, taken: bool, told: str) -> str:
    """What became of a command."""
    return _block(f"<b>{escape(words)}</b>: {_colored(escape(told), '' if taken else _ALARM)}")


def _rate(status: ProcessStatus) -> str:
    if not status.nominal_hz:
        return "event"
    off = abs(status.rate_hz / status.nominal_hz - 1.0) > RATE_BAND
    return _colored(f"{status.rate_hz:.0f}/{status.nominal_hz:.0f}", _WARN if off else "")


def _bar(name: str, held_n: float, asked: float, most_n: float) -> str:
    """What was held, filled, inside a frame of what is asked."""
    share, frame = 100.0 * max(held_n, 0.0) / most_n, 100.0 * max(asked, 0.0) / most_n
    return (
        "<div style='display:flex;align-items:center;gap:6px;height:15px'>"
        f"<span style='width:26px'>{name}</span>"
        "<span style='position:relative;flex:1;height:9px'>"
        f"<span style='position:absolute;height:9px;width:{share:.0f}%;background:{_css(MEASURED)}'></span>"
        f"<span style='position:absolute;height:9px;width:{frame:.0f}%;border:1.5px solid {_css(ASKED)};"
        "box-sizing:border-box'></span></span>"
        "<span style='min-width:84px;text-align:right;white-space:nowrap'>"
        f"{held_n:.0f} of {asked:.0f} N</span></div>"
    )


def _gauge(moved_m: float | None, limit_m: float) -> str:
    """How far the foot has moved, and the mark that is a collapse."""
    share = 0.0 if moved_m is None else min(moved_m / limit_m / _GAUGE_FULL, 1.0)
    color = _css(VERDICT_RGB[Verdict.COLLAPSED if share * _GAUGE_FULL >= 1.0 else Verdict.HELD])
    told = "in the air" if moved_m is None else f"{1e3 * moved_m:.0f} mm"
    return (
        f"<div style='margin-top:4px'>displacement {told}, collapse at {1e3 * limit_m:.0f} mm</div>"
        "<div style='position:relative;height:10px;background:#e9ecef;border-radius:3px'>"
        f"<div style='height:10px;border-radius:3px;width:{100.0 * share:.0f}%;background:{color}'></div>"
        f"<div style='position:absolute;top:-2px;height:14px;width:2px;left:{100.0 / _GAUGE_FULL:.0f}%;"
        f"background:{_ALARM}'></div></div>"
    )


def _table(head: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    cells = "".join(
        f"<th style='text-align:left;font-weight:400;color:{_DIM}'>{escape(each)}</th>" for each in head
    )
    body = "".join(f"<tr>{''.join(f'<td>{each}</td>' for each in row)}</tr>" for row in rows)
    return f"<table style='width:100%;border-spacing:0'><tr>{cells}</tr>{body}</table>"


def _swatch(rgb: Rgb) -> str:
    style = "display:inline-block;width:10px;height:10px;border-radius:2px;vertical-align:-1px"
    return f"<span style='{style};background:{_css(rgb)}'></span>"


def _colored(text: str, color: str) -> str:
    return f"<span style='color:{color}'>{text}</span>" if color else text


def _css(rgb: Rgb) -> str:
    return f"rgb{tuple(rgb)}"


def _block(html: str) -> str:
    return f"<div style='{_STYLE}'>{html}</div>"
