"""Which machine runs what, and how the machines reach each other. The default is one machine, closed to others."""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import dataclass, field

from surefoot.config.typed_toml import ConfigError

COMPONENTS = ("io", "estimator", "wbc", "mpc", "fsm", "trajopt", "elevation_map")
"""All that a deployment runs."""

OPERATOR = "operator"
"""The host name of a machine that runs nothing and only watches and commands."""

_ENDPOINT = re.compile(r"(?P<protocol>[a-z]+)/(?P<host>\[[0-9A-Fa-f:.]+\]|[A-Za-z0-9.-]+):(?P<port>[0-9]{1,5})")
_NAME = re.compile(r"[A-Za-z0-9_.:-]+")
_LOOPBACK = re.compile(r"localhost|127\.\d+\.\d+\.\d+|\[::1\]")


@dataclass(frozen=True)
class Network:
    """Hosts and their components; the process of io is the hub to which every other connects.

    Processes beside io use a Unix socket. Those of other hosts use mutual TLS, and what they may say follows
    from `hosts`.
    """

    host: str = ""  # this machine's name, set by `surefoot run --host`; "": the machine of io
    hosts: dict[str, tuple[str, ...]] = field(default_factory=lambda: {"robot": COMPONENTS})  # what runs where
    listen: str = ""  # where the hub awaits other machines, such as "tls/0.0.0.0:7448"; "": nowhere
    address: str = ""  # name or IP address by which the others reach the hub; its certificate names it
    keys_dir: str = "keys"  # of `surefoot keys init`, relative to the working directory
    insecure: bool = False  # allows listen = "tcp/127.0.0.1:PORT", without keys, for all users of this machine

    def __post_init__(self) -> None:
        self._check_hosts()
        self._check_listen()
        if len(self.hosts) > 1:
            others = ", ".join(name for name in self.hosts if name != self.hub)
            if not self.listen:
                raise ConfigError(f'listen is empty: {others} cannot reach {self.hub}; such as "tls/0.0.0.0:7448"')
            if not self.address:
                raise ConfigError(
                    f"address is empty: give the name or IP address by which {others} reach {self.hub}"
                )
        if self.address and not _NAME.fullmatch(self.address):
            raise ConfigError(f"address = {self.address!r}: a host name or an IP address, the port is listen's")
        if self.host not in ("", OPERATOR, *self.hosts):
            raise ConfigError(f"host = {self.host!r}: hosts has {', '.join(self.hosts)}")

    @property
    def hub(self) -> str:
        """The host of io."""
        return self.host_of("io")

    @property
    def here(self) -> str:
        """This machine's name."""
        return self.host or self.hub

    @property
    def at_hub(self) -> bool:
        """Whether io runs on this machine."""
        return self.here == self.hub

    @property
    def components_here(self) -> tuple[str, ...]:
        """What runs on this machine."""
        return self.hosts.get(self.here, ())

    @property
    def components_away(self) -> tuple[str, ...]:
        """What runs on other machines than io."""
        return tuple(name for host, names in self.hosts.items() if host != self.hub for name in names)

    @property
    def encrypted(self) -> bool:
        """Whether other machines are told by their certificates."""
        return self.listen.startswith("tls/")

    @property
    def hub_endpoint(self) -> str:
        """Where other machines find the hub.

        Raises:
            ConfigError: it does not listen to other machines, or has no address.
        """
        if not self.listen or not self.address:
            missing = "listen" if not self.listen else "address"
            raise ConfigError(f"network.{missing} is empty: {self.hub} cannot be reached from another machine")
        protocol, _, port = self._endpoint
        host = f"[{self.address}]" if ":" in self.address else self.address
        return f"{protocol}/{host}:{port}"

    def host_of(self, component: str) -> str:
        """Where a component runs."""
        return next(host for host, names in self.hosts.items() if component in names)

    @property
    def _endpoint(self) -> tuple[str, str, int]:
        """Protocol, host and port of `listen`.

        Raises:
            ConfigError: it is not one that Surefoot uses.
        """
        match = _ENDPOINT.fullmatch(self.listen)
        if match is None or match["protocol"] not in ("tls", "tcp") or not 0 < int(match["port"]) < 65536:
            raise ConfigError(f'listen = {self.listen!r}: such as "tls/0.0.0.0:7448", an address of this machine')
        return match["protocol"], match["host"], int(match["port"])

    def _check_hosts(self) -> None:
        counts = Counter(name for names in self.hosts.values() for name in names)
        for host, names in self.hosts.items():
            for name in names:
                if name not in COMPONENTS:
                    raise ConfigError(f"hosts.{host}: no component {name!r}; there are {', '.join(COMPONENTS)}")
                if counts[name] > 1:
                    raise ConfigError(f"hosts.{host}: {name} runs twice; each component runs on one host")
        missing = [name for name in COMPONENTS if name not in counts]
        if missing:
            raise ConfigError(f"hosts: {', '.join(missing)} runs nowhere; name each component once")
        if self.hub == OPERATOR:
            raise ConfigError(
                f"hosts.{OPERATOR}: io cannot run there; that name means a machine without the robot"
            )

    def _check_listen(self) -> None:
        if not self.listen:
            return
        protocol, host, _ = self._endpoint
        if protocol == "tcp" and not self.insecure:
            raise ConfigError(
                f"listen = {self.listen!r}: tcp lets everyone in; use tls and `surefoot keys init`, or "
                "insecure = true on this machine alone"
            )
        if protocol == "tcp" and not _LOOPBACK.fullmatch(host):
            raise ConfigError(f"listen = {self.listen!r}: without keys only 127.0.0.1 may listen; use tls")
