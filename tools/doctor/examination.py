"""All checks of a deployment, group by group."""

from __future__ import annotations

from collections.abc import Callable

from surefoot.bus.hub_socket import hub_owner
from surefoot.config.deployment import Deployment
from surefoot.hw.errors import HardwareFault
from surefoot.tools.doctor.check import Finding, Findings, Level, does_not_apply, failures
from surefoot.tools.doctor.machine import check_machine, look_at_machine
from surefoot.tools.doctor.network import check_network, look_around
from surefoot.tools.doctor.robot_link import check_link
from surefoot.tools.doctor.robot_state import check_state
from surefoot.tools.doctor.talk import talk

NOTHING_MOVES = (
    "the robot is sent zero gains until it answers, then damping for {seconds:g} s: nothing moves, but one that "
    "stands sinks down"
)


def examine(deployment: Deployment, say: Callable[[str], None]) -> Findings:
    """Everything that can be checked without motion.

    Args:
        deployment: robot, link and limits.
        say: told before anything is sent.
    """
    findings = examine_robot(deployment, say)
    findings["machine"] = check_machine(look_at_machine(deployment), deployment.run, deployment.doctor)
    return findings


def examine_robot(deployment: Deployment, say: Callable[[str], None]) -> Findings:
    """The way to the robot, the exchange with it and its state; nothing is sent while a run is up."""
    wire, network = deployment.hw.aliengo, deployment.network
    why = ""
    if deployment.hw.backend != "aliengo":
        why = f"hw.backend = {deployment.hw.backend!r}: there is no robot on a wire"
    elif not network.at_hub:
        why = f"the robot's wire is at {network.hub}: examine it there"
    if why:
        return {group: [does_not_apply(group, why)] for group in ("network", "link", "robot")}
    seen = look_around(wire, hub_owner(deployment.run.namespace))
    findings: Findings = {"network": check_network(seen, wire)}
    if seen.owner or failures(findings):
        why = f"a run is up ({seen.owner})" if seen.owner else "there is no way to the robot, see above"
        return findings | {
            group: [does_not_apply(group, f"nothing was sent: {why}")] for group in ("link", "robot")
        }
    say(NOTHING_MOVES.format(seconds=deployment.doctor.watch_s))
    return findings | _talked(deployment)


def _talked(deployment: Deployment) -> Findings:
    silent = [does_not_apply("state", "there is none")]
    try:
        heard = talk(deployment)
    except HardwareFault as fault:
        failed = Finding("answer", Level.FAIL, str(fault), "a way to the robot", "see the network's checks")
        return {"link": [failed], "robot": silent}
    link = check_link(heard, deployment.hw.aliengo, deployment.doctor)
    if not heard.states:
        return {"link": link, "robot": silent}
    rested = heard.states[len(heard.states) // 2 :]  # it has sunk into its damping by then
    state = check_state(rested, heard.remote, deployment.load_robot(), deployment.doctor)
    return {"link": link, "robot": state}
