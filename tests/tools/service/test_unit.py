"""What a unit says, and what systemd thinks of it."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from surefoot.bus.topics import PROCESSES
from surefoot.config.deployment import load_deployment
from surefoot.config.operator import Operator
from surefoot.config.typed_toml import ConfigError
from surefoot.tools.cli import main
from surefoot.tools.commands.call import deployment_file
from surefoot.tools.launcher import KILL_AFTER_S
from surefoot.tools.service.systemd import ServiceError, check_service, check_systemd, folder_of
from surefoot.tools.service.unit import Service

ALIENGO = deployment_file("aliengo")


def service(folder=Path("/home/dog"), config=ALIENGO, **settings):
    return Service(config, Path(sys.executable), folder, **settings)


def lines(text):
    return dict(line.split("=", 1) for line in text.splitlines() if "=" in line and not line.startswith("#"))


def test_it_runs_this_environments_interpreter_by_absolute_paths():
    said = lines(service(config=Path("config/aliengo.toml")).text())
    config = Path("config/aliengo.toml").absolute()
    assert said["ExecStart"] == f"{sys.executable} -P -m surefoot.tools.cli run {config} --plain"
    assert said["ExecStartPre"] == f"{sys.executable} -P -m surefoot.tools.cli doctor {config}"
    assert said["WorkingDirectory"] == "/home/dog"


def test_it_may_run_in_real_time_and_is_never_restarted_by_itself():
    said = lines(service(cpus="2-5").text())
    assert said["LimitRTPRIO"] == "80" and said["LimitMEMLOCK"] == "infinity" and said["CPUAffinity"] == "2-5"
    assert said["Restart"] == "no"
    assert "CPUAffinity" not in service().text()


def test_it_belongs_to_the_machine_or_to_a_user():
    assert lines(service().text())["WantedBy"] == "multi-user.target"
    assert lines(service(user=True).text())["WantedBy"] == "default.target"
    assert service().name == "surefoot-aliengo.service"


def test_words_with_spaces_and_signs_stay_one_word():
    said = lines(service(folder=Path("/home/a dog"), config=Path("/home/a $dog/50%.toml")).text())
    assert '"/home/a $$dog/50%%.toml"' in said["ExecStart"] and said["WorkingDirectory"] == "/home/a dog"


@pytest.mark.skipif(shutil.which("systemd-analyze") is None, reason="needs systemd-analyze")
@pytest.mark.parametrize("settings", [{}, {"cpus": "0,1", "user": True}])
def test_systemd_takes_it(settings, tmp_path):
    unit = service(tmp_path, **settings)
    path = tmp_path / unit.name
    path.write_text(unit.text())
    verify = ["systemd-analyze", "verify", *(["--user"] if unit.user else []), str(path)]
    done = subprocess.run(verify, capture_output=True, text=True, env={"XDG_RUNTIME_DIR": str(tmp_path)})
    assert unit.name not in done.stderr and done.returncode == 0, done.stderr


def test_a_robot_that_would_get_up_by_itself_is_refused():
    check_service(service(), load_deployment(ALIENGO))
    with pytest.raises(ConfigError, match="nobody there"):
        check_service(service(), load_deployment(ALIENGO, ["run.command=stand"]))


def test_the_supervisor_alone_is_told_to_stop_and_has_the_time_that_the_robot_may_take():
    said = lines(service().text())
    assert said["KillMode"] == "process" and said["OOMPolicy"] == "continue"
    longest_s = Operator(settle_s=120.0).settle_s + (len(PROCESSES) + 1) * KILL_AFTER_S
    assert float(said["TimeoutStopSec"]) > longest_s


def test_it_runs_under_the_name_of_who_called_sudo():
    assert lines(service(account="dog").text())["User"] == "dog" and "User" not in lines(service().text())


@pytest.mark.parametrize(
    "settings", [{"cpus": "all"}, {"cpus": "2-"}, {"cpus": "1-0"}, {"cpus": "0-4096"}, {"folder": Path("/a\nb")}]
)
def test_what_cannot_stand_in_a_unit_is_refused(settings):
    with pytest.raises(ServiceError):
        check_service(service(**settings), load_deployment(ALIENGO))


def test_without_systemd_it_is_refused_with_what_to_do_instead(tmp_path, monkeypatch, capsys):
    with pytest.raises(ServiceError, match="surefoot run CONFIG --plain"):
        check_systemd(tmp_path / "nowhere")
    monkeypatch.setenv("PATH", "")
    assert main(["service", "install", "aliengo"]) == 2
    assert "systemd does not run this machine" in capsys.readouterr().err


def test_a_users_units_are_in_their_configuration(monkeypatch, tmp_path):
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    assert folder_of(user=True) == tmp_path / "systemd" / "user"
    assert folder_of(user=False) == Path("/etc/systemd/system")
