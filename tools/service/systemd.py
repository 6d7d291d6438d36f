"""Installs units, and asks systemd about them."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path

from surefoot.config.deployment import Deployment
from surefoot.config.typed_toml import ConfigError
from surefoot.tools.service.unit import Service

BOOTED = Path("/run/systemd/system")
"""Is there exactly where systemd is the machine's init."""

_CPUS = re.compile(r"\d+(-\d+)?([, ]\d+(-\d+)?)*")


class ServiceError(RuntimeError):
    """A service that cannot be had; says why and what would be right."""


def check_systemd(booted: Path = BOOTED) -> None:
    """See that there is a systemd.

    Raises:
        ServiceError: there is none.
    """
    if not booted.is_dir() or shutil.which("systemctl") is None:
        raise ServiceError(
            f"systemd does not run this machine (no {booted}): start `surefoot run CONFIG --plain` by what does"
        )


def check_service(service: Service, deployment: Deployment) -> None:
    """See that a deployment may be started with nobody there.

    Raises:
        ConfigError: the robot would set off by itself.
        ServiceError: `cpus` is no list of this machine's cores, or a path has a line break in it.
    """
    if deployment.hw.backend == "aliengo" and deployment.run.command:
        raise ConfigError(
            f"run.command = {deployment.run.command!r}: the robot would get up as soon as the service starts, "
            'with nobody there; set ""'
        )
    if service.cpus and not _CPUS.fullmatch(service.cpus):
        raise ServiceError(f"--cpus {service.cpus!r}: a list of cores such as 2-5 or 2,3")
    cores = os.cpu_count() or 1
    for first, last in re.findall(r"(\d+)-?(\d*)", service.cpus):
        if not int(first) <= int(last or first) < cores:
            raise ServiceError(f"--cpus {service.cpus}: this machine has cores 0 to {cores - 1}")
    if "\n" in f"{service.config}{service.folder}{service.python}":
        raise ServiceError("a path with a line break cannot stand in a unit: rename the folder")


def folder_of(user: bool) -> Path:
    """Where units are kept that people write."""
    if not user:
        return Path("/etc/systemd/system")
    config = os.environ.get("XDG_CONFIG_HOME") or Path.home() / ".config"
    return Path(config) / "systemd" / "user"


def install(service: Service, at_boot: bool, folder: Path) -> Path:
    """Write the unit and make it known.

    Args:
        service: what is to run.
        at_boot: it is also started with the machine; if not, no longer.
        folder: of units.

    Raises:
        ServiceError: it may not be written there, or systemd refuses it.
    """
    path = folder / service.name
    try:
        folder.mkdir(parents=True, exist_ok=True)
        path.write_text(service.text())
    except OSError as error:
        raise ServiceError(f"{path}: {error.strerror}; use sudo, or --user for a unit of your own") from None
    _control(service.user, "daemon-reload")
    _control(service.user, "enable" if at_boot else "disable", service.name)
    return path


def remove(service: Service, folder: Path) -> Path:
    """Stop it, which has the robot sit down first, and take the unit away.

    Raises:
        ServiceError: there is no such unit, or it may not be removed.
    """
    path = folder / service.name
    if not path.exists():
        raise ServiceError(f"there is no {path}: `surefoot service install` makes one (with --user: your own)")
    _control(service.user, "disable", "--now", service.name)
    try:
        path.unlink()
    except OSError as error:
        raise ServiceError(f"{path}: {error.strerror}; use sudo") from None
    _control(service.user, "daemon-reload")
    return path


def show(service: Service, program: str, *words: str) -> int:
    """Let `systemctl` or `journalctl` tell of it; returns their exit code."""
    whose = ["--user"] if service.user else []
    return subprocess.run([program, *whose, *words], check=False).returncode


def _control(user: bool, *words: str) -> None:
    command: Sequence[str] = ["systemctl", *(["--user"] if user else []), *words]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        raise ServiceError(f"`{' '.join(command)}` failed: {done.stderr.strip() or done.stdout.strip()}")
