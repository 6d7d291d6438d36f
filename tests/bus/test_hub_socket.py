"""On one machine the bus is closed to other users by its folder, and says which process holds it."""

import os
import tempfile

import pytest

from surefoot.bus.errors import BusError
from surefoot.bus.hub_socket import hub_owner, refuse_second_hub, socket_path
from surefoot.bus.session import Session


@pytest.fixture
def folder(monkeypatch):
    """Where the socket of any namespace is to lie."""
    with tempfile.TemporaryDirectory() as place:
        monkeypatch.setattr(tempfile, "tempdir", place)
        yield socket_path("any").parent


def test_the_folder_is_made_for_one_user_and_the_hub_is_told_by_its_process(folder):
    assert hub_owner("any") == ""
    hub = Session("any", hub=True)
    assert folder.stat().st_mode & 0o777 == 0o700
    assert hub_owner("any") == f"process {os.getpid()}"
    with pytest.raises(BusError, match=f"process {os.getpid()} already serves namespace 'any'"):
        refuse_second_hub("any")
    hub.close()
    assert hub_owner("any") == ""


def opened(folder):
    folder.mkdir()
    folder.chmod(0o755)


def another_users(folder):
    folder.mkdir(mode=0o700)
    os.chown(folder, 65534, -1)


def leading_elsewhere(folder):
    folder.with_name("elsewhere").mkdir(mode=0o700)
    folder.symlink_to("elsewhere")


@pytest.mark.parametrize("hub", [True, False], ids=["hub", "client"])
@pytest.mark.parametrize("made", [opened, another_users, leading_elsewhere])
def test_a_folder_that_others_could_use_is_refused_by_both_sides(folder, made, hub):
    if made is another_users and os.getuid() != 0:
        pytest.skip("only root can give a folder away")
    made(folder)
    with pytest.raises(BusError, match=rf"is not a folder of user {os.getuid()} alone .* remove it"):
        Session("any", hub=hub, connect_ms=100)
