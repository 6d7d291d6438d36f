"""Whether a live run said what the same run says in one process, byte by byte."""

from __future__ import annotations

from dataclasses import replace

from surefoot.bus.codec import decode, encode
from surefoot.bus.message import Message
from surefoot.bus.messages import OperatorCommand
from surefoot.bus.topics import TOPICS
from surefoot.components.lockstep import Lockstep
from surefoot.config.deployment import Deployment


def first_difference(deployment: Deployment, heard: dict[str, list[bytes]], until_s: float) -> tuple[float, str]:
    """When, and on which topic, a run with simulated time first differs from itself without faults.

    Args:
        deployment: of both.
        heard: what was published live, by topic.
        until_s: how far to compare [s].

    Returns:
        Time [s] and words; infinite and empty if nothing differs.
    """
    live: dict[str, dict[int, bytes]] = {}
    for key, payloads in heard.items():
        # Half a step of a process that was restarted within it is repeated: the last one counts.
        live[key] = {decode(TOPICS[key].message, payload).seq: payload for payload in payloads}
    found: list[tuple[float, str]] = []
    stack = Lockstep(deployment)

    def compare(key: str, message: Message) -> None:
        payload = live.get(key, {}).get(message.seq)
        if found:
            return
        if payload is None:
            found.append((message.t, f"{key}: message {message.seq} is missing"))
            return
        said = replace(decode(TOPICS[key].message, payload), boot=0)
        if encode(said, volatile=False) != encode(message, volatile=False):
            found.append((message.t, f"{key} differs at message {message.seq}"))

    stack.listen(compare)
    for payload in heard["operator/command"]:
        command = decode(OperatorCommand, payload)
        if command.t > 0.0:
            stack.run(min(command.t, until_s), lambda: bool(found))
        if command.t < until_s:
            stack.command(command.command)
    stack.run(until_s, lambda: bool(found))
    return found[0] if found else (float("inf"), "")
