"""The Zenoh session of one process: the only module that imports zenoh.

The process of `io` is the hub, a router on a Unix socket in a folder that only its user may enter; every
other process is its client. Multicast and gossip are off: nothing leaves the machine, unless the deployment's
`network` section has the hub listen to other machines too.
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from zlib import crc32

import zenoh

from surefoot.bus.endpoints import client_side, hub_side
from surefoot.bus.errors import BusError
from surefoot.bus.hub_socket import check_folder, hub_owner, socket_path, take_socket
from surefoot.config.network import Network

_CONNECT_MS = 30_000
_MARK_BYTES = 32
_SUM_BYTES = 4
_POOLS = ("rx", "tx", "net", "acc")
"""The pools of threads that Zenoh has beside the one for applications."""
_TX = {
    "lease": 2000,
    "keep_alive": 4,
    # A stream to a reader that is late is dropped at once: to wait for it would hold up the others. Where every
    # message counts, a reader that takes none for so long [us] is cut off: the whole bus stands still meanwhile.
    "queue": {
        "size": {"data": 16, "real_time": 16},
        "congestion_control": {"drop": {"wait_before_drop": 0}, "block": {"wait_before_close": 2_000_000}},
    },
}


def keep_to_one_thread() -> None:
    """Let Zenoh do all its work of this process on one thread; to be called before the first session.

    By default a message that comes in wakes three threads one after the other, and that is most of its price. Only
    for processes that listen: elsewhere, while one thread waits for a reader that is late, others have to send.
    """
    os.environ.setdefault("ZENOH_RUNTIME", f"({', '.join(f'{pool}: (handover: app)' for pool in _POOLS)})")


class Marked(bytes):
    """Bytes from the bus, with the mark of the session that published them.

    Attributes:
        writer: the session's own, as the bus numbers it; empty when the bytes came some other way.
    """

    writer: bytes = b""


class Session:
    """Publishes and subscribes bytes under a namespace.

    A link that Zenoh gives up while it writes may hand what was queued to the reader out of step: parts of several
    messages as one, under a key of any. So bytes travel with a checksum, and damaged ones are dropped.

    Attributes:
        namespace: prefix of every key on the wire.
        where: the endpoint of the hub, for people.
        beside_hub: the hub is on this machine.
        mark: what it publishes bears it; no other session has the same.
        damaged: messages and answers that were dropped because they were not what their writer sent.
    """

    def __init__(
        self,
        namespace: str,
        hub: bool = False,
        connect_ms: int = _CONNECT_MS,
        network: Network | None = None,
    ):
        """Open the hub, or connect to it.

        Args:
            namespace: prefix of every key on the wire.
            hub: open it.
            connect_ms: how long to try to connect [ms].
            network: of the deployment; None is one machine, closed to others.

        Raises:
            BusError: no hub answers, another hub already runs under this namespace, others may enter its socket's
                folder, or this machine's keys cannot be used.
            ConfigError: the deployment has no way from this machine to the hub.
        """
        network = network or Network()
        self.namespace = self._prefix = namespace
        self.beside_hub = network.at_hub
        path = socket_path(namespace)
        local = f"unixsock-stream/{path}"
        if hub:
            self.where, side = str(path), hub_side(network, namespace, local)
            take_socket(namespace)
        elif network.at_hub:
            check_folder(namespace)
            self.where, side = str(path), {"connect": {"endpoints": [local]}}
        else:
            self.where, side = network.hub_endpoint, client_side(network)
        try:
            self._session = zenoh.open(zenoh.Config.from_json5(json.dumps(_config(side, hub, connect_ms))))
        except zenoh.ZError as error:
            raise BusError(_no_session(self.where, namespace, network, hub, str(error))) from None
        self.mark = _mark_of(self._session.info.zid())
        self._hubs: tuple[bytes, ...] = (self.mark,) if hub else ()
        self.damaged = 0
        self._publishers: dict[str, zenoh.Publisher] = {}
        self._kept: list[object] = []

    def hub_marks(self) -> tuple[bytes, ...]:
        """Of the hub this session is connected to, or was last; its own if it is one."""
        if self.mark not in self._hubs:
            self._hubs = tuple(map(_mark_of, self._session.info.routers_zid())) or self._hubs
        return self._hubs

    def put(self, key: str, payload: bytes, lossless: bool = True) -> None:
        """Publish bytes on a key of the namespace.

        Args:
            key: what follows the namespace.
            payload: the bytes.
            lossless: block while a reader's queue is full. In real time a stream must not: one slow reader, a
                display, would hold up the control chain. What the first message of a key asks, all get.
        """
        publisher = self._publishers.get(key)
        if publisher is None:
            control = zenoh.CongestionControl.BLOCK if lossless else zenoh.CongestionControl.DROP
            publisher = self._session.declare_publisher(f"{self._prefix}/{key}", congestion_control=control)
            self._publishers[key] = publisher
        publisher.put(payload, attachment=self._seal(f"{self._prefix}/{key}", payload))

    def subscribe(self, key: str, receive: Callable[[str, Marked], None]) -> None:
        """Call `receive(key, bytes)` for every message; it must only store, it runs in the session's thread.

        The bytes bear their writer's mark.
        """
        skip = len(self._prefix) + 1

        def on_sample(sample: zenoh.Sample) -> None:
            if (payload := self._whole(sample)) is not None:
                receive(str(sample.key_expr)[skip:], payload)

        self._kept.append(self._session.declare_subscriber(f"{self._prefix}/{key}", on_sample))

    def newest(self, key: str) -> Callable[[], Marked | None]:
        """A function that gives the newest message since it was last called, or None.

        Nothing runs between two calls, whatever the topic's rate: right for a display.
        """
        subscriber = self._session.declare_subscriber(f"{self._prefix}/{key}", zenoh.handlers.RingChannel(1))
        self._kept.append(subscriber)

        def take() -> Marked | None:
            sample = subscriber.try_recv()
            return None if sample is None else self._whole(sample)

        return take

    def serve(self, key: str, answer: Callable[[], list[bytes]]) -> None:
        """Give `answer()` to everyone who asks for a key; it runs in the session's thread."""
        whole = f"{self._prefix}/{key}"

        def on_query(query: zenoh.Query) -> None:
            with query:
                answers = answer()
                for index, payload in enumerate(answers):
                    each = f"{whole}/{index}-{len(answers)}"
                    query.reply(each, payload, attachment=self._seal(each, payload))

        self._kept.append(self._session.declare_queryable(f"{whole}/*", on_query))

    def ask(self, key: str, timeout_s: float = 2.0) -> list[Marked]:
        """What is served under a key, in order; empty when nobody serves it, or not all of it has come in time.

        Of two that serve it everything comes, first all of one of them.
        """
        replies = self._session.get(
            f"{self._prefix}/{key}/*", timeout=timeout_s, consolidation=zenoh.ConsolidationMode.NONE
        )
        answers: dict[bytes, dict[int, Marked]] = {}
        counts: dict[bytes, int] = {}
        for reply in replies:
            if reply.ok is None:
                continue
            index, _, total = str(reply.ok.key_expr).rsplit("/", 1)[1].partition("-")
            if index.isdecimal() and total.isdecimal() and (payload := self._whole(reply.ok)) is not None:
                answers.setdefault(payload.writer, {})[int(index)] = payload
                counts[payload.writer] = int(total)
        whole = [writer for writer in sorted(answers) if len(answers[writer]) == counts[writer]]
        return [answers[writer][index] for writer in whole for index in sorted(answers[writer])]

    def serve_each(self, key: str, answer: Callable[[int], bytes | None]) -> None:
        """Give `answer(number)`, if there is one, to everyone who asks for a number of a key."""
        whole = f"{self._prefix}/{key}"

        def on_query(query: zenoh.Query) -> None:
            with query:
                number = str(query.key_expr).rsplit("/", 1)[1]
                payload = answer(int(number)) if number.isdecimal() else None
                if payload is not None:
                    each = f"{whole}/{number}"
                    query.reply(each, payload, attachment=self._seal(each, payload))

        self._kept.append(self._session.declare_queryable(f"{whole}/*", on_query))

    def ask_each(self, key: str, number: int, timeout_s: float = 2.0) -> bytes | None:
        """What is served under a number of a key; None when nobody has it.

        Raises:
            BusError: who may have it did not answer in time.
        """
        for reply in self._session.get(f"{self._prefix}/{key}/{number}", timeout=timeout_s):
            if reply.ok is None or (payload := self._whole(reply.ok)) is None:
                raise BusError(f"no answer on {key}/{number} in {timeout_s:g} s, or a damaged one")
            return payload
        return None

    def close(self) -> None:
        """Leave the bus."""
        self._session.close()

    def _seal(self, key: str, payload: bytes) -> bytes:
        """What goes with bytes: this session's mark, and a checksum of whole key and bytes."""
        return self.mark + _sum(key, payload)

    def _whole(self, sample: zenoh.Sample) -> Marked | None:
        """The bytes of a sample with their writer's mark; None, and counted, when they are not what it sent."""
        payload = Marked(sample.payload.to_bytes())
        if sample.attachment is not None:
            seal = sample.attachment.to_bytes()
            if seal[-_SUM_BYTES:] != _sum(str(sample.key_expr), payload):
                self.damaged += 1
                return None
            payload.writer = seal[:-_SUM_BYTES][:_MARK_BYTES]
        return payload


def _mark_of(session: zenoh.ZenohId) -> bytes:
    return str(session).encode()


def _sum(key: str, payload: bytes) -> bytes:
    return crc32(payload, crc32(key.encode())).to_bytes(_SUM_BYTES, "big")


def _no_session(where: str, namespace: str, network: Network, hub: bool, error: str) -> str:
    """Why a session could not be opened, in words."""
    if hub:
        also = f" or {network.listen}: is the port taken, the address this machine's?" if network.listen else ""
        return f"cannot listen on {where}{also} ({error})"
    if network.at_hub and (owner := hub_owner(namespace)):
        return f"{owner} holds the bus on {where} and does not answer: is it stopped? ({error})"
    if network.at_hub:
        return f"nothing answers on {where}: is `surefoot run` running with namespace {namespace!r}? ({error})"
    return (
        f"nothing answers on {where}: is `surefoot run` running there, does its firewall pass the port, and are "
        "the identities of both machines of one `surefoot keys init`? A refused certificate looks the same. "
        f"({error})"
    )


def _config(side: dict, hub: bool, connect_ms: int) -> dict:
    """Zenoh's configuration for one side of the bus."""
    link: dict = {"tx": _TX}
    if "tls" in side:
        link["tls"] = side["tls"]
    config: dict = {
        "mode": "router" if hub else "client",
        "scouting": {"multicast": {"enabled": False}, "gossip": {"enabled": False}},
        "transport": {"shared_memory": {"enabled": False}, "link": link},
    }
    for section in ("listen", "connect", "access_control"):
        if section in side:
            config[section] = dict(side[section])
    if not hub:
        config["connect"] |= {
            "timeout_ms": connect_ms,
            "exit_on_failure": True,
            "retry": {"period_init_ms": 50, "period_max_ms": 200, "period_increase_factor": 1},
        }
    return config
