"""Checks of the exchange with the robot: who answers, in which generation, how often, how late."""

from __future__ import annotations

from surefoot.bus.topics import CYCLE_HZ
from surefoot.config.aliengo import Aliengo
from surefoot.config.doctor import Doctor
from surefoot.hw.aliengo.generation import GENERATIONS
from surefoot.hw.aliengo.link_statistics import LinkStatistics
from surefoot.hw.aliengo.tick_clock import UNITS_S
from surefoot.tools.doctor.check import Finding, Level, does_not_apply, graded, well
from surefoot.tools.doctor.talk import Heard

_WRAP = 1 << 32
_UNIT_ERROR = 0.05  # of the tick's pace: what is watched is short, and packets come late


def check_link(heard: Heard, wire: Aliengo, limits: Doctor) -> list[Finding]:
    """All findings of this group; what cannot be known without a good state is left out."""
    findings = [check_answer(heard, wire), check_generation(heard, wire)]
    if heard.statistics is None:
        return findings
    findings.append(check_tick(heard, wire))
    return [*findings, *check_exchange(heard.statistics, wire, limits), check_damage(heard, limits)]


def check_answer(heard: Heard, wire: Aliengo) -> Finding:
    """Whether there is a good state."""
    check, expected = "answer", f"states of {wire.address}:{wire.port}"
    count = sum(heard.lengths.values())
    if heard.states:
        return well(check, f"{count} packets", expected)
    if not count:
        remedy = "switch it on; once its own program runs, L2+A and L1+L2+START on its remote: low-level mode"
        trouble = f" ({heard.trouble})" if heard.trouble else ""
        return Finding(check, Level.FAIL, f"silence for {wire.first_answer_s:g} s{trouble}", expected, remedy)
    return Finding(check, Level.FAIL, f"{count} packets, none that can be used", expected, heard.trouble)


def check_generation(heard: Heard, wire: Aliengo) -> Finding:
    """Whose packets they are, by their length."""
    check, expected = "generation", f"{wire.generation}, {GENERATIONS[wire.generation].state.length} bytes"
    if not heard.lengths:
        return does_not_apply(check, "nothing came")
    lengths = ", ".join(f"{length} bytes" for length in sorted(heard.lengths))
    if heard.generations == (wire.generation,):
        return well(check, f"{wire.generation}, {lengths}", expected)
    others = [name for name in heard.generations if name != wire.generation]
    if others:
        remedy = f'set hw.aliengo.generation = "{others[0]}"'
        return Finding(check, Level.FAIL, f"{' and '.join(others)}, {lengths}", expected, remedy)
    remedy = "another program or robot answers at this address: check hw.aliengo.address and port"
    return Finding(check, Level.FAIL, f"neither G0 nor G1: {lengths}", expected, remedy)


def check_tick(heard: Heard, wire: Aliengo) -> Finding:
    """Whether the robot's clock goes on, and in which unit."""
    check, expected = "tick", f"hw.aliengo.tick_unit = {wire.tick_unit}"
    if len(heard.states) < 2:
        remedy = "its control board hangs: switch the robot off and on"
        return Finding(check, Level.FAIL, f"it stands at {heard.states[0].tick}", "a tick that moves", remedy)
    if wire.exchange == "cycle":
        return does_not_apply(check, "it moves; its time waits for commands, so nothing tells the unit")
    ticks = (heard.states[-1].tick - heard.states[0].tick) % _WRAP
    pace = ticks / (heard.arrived[-1] - heard.arrived[0])
    unit = next((name for name, unit_s in UNITS_S.items() if abs(pace * unit_s - 1.0) < _UNIT_ERROR), "")
    if unit and wire.tick_unit in ("auto", "none", unit):
        return well(check, f"{unit}, {pace:.0f} a second", expected)
    if unit:
        remedy = f'set hw.aliengo.tick_unit = "{unit}", or "auto"'
        return Finding(check, Level.FAIL, f"{unit}, {pace:.0f} a second", expected, remedy)
    remedy = 'set hw.aliengo.tick_unit = "none": states are then timed by their arrival'
    level = Level.OK if wire.tick_unit == "none" else Level.WARN
    return Finding(check, level, f"{pace:.0f} a second, neither us nor ms", expected, remedy)


def check_exchange(found: LinkStatistics, wire: Aliengo, limits: Doctor) -> list[Finding]:
    """How often and how soon commands are answered."""
    if wire.exchange == "cycle":
        return [does_not_apply("rate", "time waits for the exchange")]
    skipped = f", {found.overruns} cycles left out here" if found.overruns else ""
    rate = f"{found.rate_hz:.0f} answers a second{skipped}"
    remedy = "plug into the robot itself, with another cable"
    if found.overruns > limits.loss_warn * found.commands:
        remedy = "this machine is late: see its timer"
    late = (
        f"{found.latency_ms:.2f} ms, the longest {found.latency_max_ms:.1f} ms",
        f"a median within {limits.latency_warn_ms:g} ms",
        remedy,
    )
    lost = (
        f"{100 * found.loss:.1f} % of {found.commands} commands without a new state",
        f"within {100 * limits.loss_warn:g} %",
        remedy,
    )
    missing = max(1.0 - found.rate_hz / CYCLE_HZ, 0.0)
    return [
        graded("rate", missing, (limits.loss_warn, limits.loss_fail), (rate, f"{CYCLE_HZ:.0f}", remedy)),
        graded("loss", found.loss, (limits.loss_warn, limits.loss_fail), lost),
        graded("latency", found.latency_ms, (limits.latency_warn_ms, limits.latency_fail_ms), late),
    ]


def check_damage(heard: Heard, limits: Doctor) -> Finding:
    """Packets whose checksum is wrong, or that tell what no robot measures."""
    found = heard.statistics
    bad = found.checksum_errors + found.refused if found is not None else 0
    share = bad / max(sum(heard.lengths.values()), 1)
    said = f"{bad} packets, {100 * share:.1f} %" + (f": {heard.trouble}" if bad else "")
    words = (said, "none", "change the cable; if every packet is, hw.aliengo.generation is not the robot's")
    return graded("damaged", share, (0.0, limits.loss_fail), words)
