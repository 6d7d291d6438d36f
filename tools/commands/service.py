"""`surefoot service`: a deployment as a service of this machine."""

from __future__ import annotations

import argparse
import os
import sys
from pathlib import Path

from surefoot.tools.commands.call import CallError, deployment_file

_SERVICE = """\
Have systemd run a deployment: with the interpreter of this environment, in this folder, with the right to
real-time priority and locked memory. Before each start `surefoot doctor` examines robot and machine; if anything
fails it is not started. The robot stays damped until `surefoot command stand`.

install writes the unit; `systemctl start surefoot-NAME` starts it, `install --at-boot` also with the machine.
`systemctl stop` has the robot sit down before the run ends; so does remove, which takes the unit away. log and
status show what systemd knows of it. Root installs units of the machine, which run under the name of who called
sudo; everybody else with --user their own, which last while they are logged in. It is never restarted by itself: a
run that has ended has damped the robot, and a person is to look first.

exit code: 0 done; 2 the call was wrong or there is no systemd; log and status: that of journalctl and systemctl
"""
_ACTIONS = ("install", "remove", "log", "status")


def add(commands: argparse._SubParsersAction) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser(
        "service",
        help="let systemd run a deployment",
        formatter_class=argparse.RawDescriptionHelpFormatter,
        description=_SERVICE,
        epilog="example: sudo .venv/bin/surefoot service install aliengo --cpus 2-5",
    )
    parser.add_argument("action", choices=_ACTIONS)
    parser.add_argument("config", help="a deployment file, or its name in config/")
    parser.add_argument(
        "--user", action=argparse.BooleanOptionalAction, default=os.getuid() != 0, help="a unit of one's own"
    )
    parser.add_argument("--cpus", default="", metavar="LIST", help="install: cores it keeps to, such as 2-5")
    parser.add_argument("--at-boot", action="store_true", help="install: started with the machine")
    parser.add_argument("--follow", action="store_true", help="log: go on until Ctrl-C")
    parser.set_defaults(run=_run)


def _run(call: argparse.Namespace) -> int:
    from surefoot.config.deployment import load_deployment
    from surefoot.tools.service import systemd
    from surefoot.tools.service.unit import Service

    config = deployment_file(call.config)
    account = "" if call.user else os.environ.get("SUDO_USER", "")
    service = Service(config, Path(sys.executable), Path.cwd(), call.user, call.cpus, account)
    folder = systemd.folder_of(call.user)
    try:
        systemd.check_systemd()
        if call.action == "install":
            systemd.check_service(service, load_deployment(config))
            path = systemd.install(service, call.at_boot, folder)
            whose = " --user" if call.user else ""
            print(f"wrote {path}; `systemctl{whose} start {service.name}` starts it")
        elif call.action == "remove":
            print(f"removed {systemd.remove(service, folder)}")
        elif call.action == "log":
            words = ["--follow"] if call.follow else ["--no-pager", "--lines=200"]
            return systemd.show(service, "journalctl", "--unit", service.name, *words)
        else:
            return systemd.show(service, "systemctl", "--no-pager", "--lines=40", "status", service.name)
    except systemd.ServiceError as error:
        raise CallError(str(error)) from None
    return 0
