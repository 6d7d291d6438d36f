"""The server of `surefoot drive --browser`, to a client that speaks as its page does, on a stack that answers."""

import json
import subprocess
import sys
from contextlib import ExitStack, contextmanager, suppress
from http.client import HTTPConnection

import pytest
from driven import PATIENCE_S, Driven, served
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import connect

from surefoot.tools.cli import main
from surefoot.tools.loopback import HOST, listen

AHEAD, MIDDLE = {"stick": [0.0, -1.0], "down": []}, {"stick": [0.0, 0.0], "down": []}


@pytest.fixture
def serve():
    """Makes a stack and a page that drives it."""
    with ExitStack() as made:
        yield lambda *args, **settings: made.enter_context(served(*args, **settings))


@contextmanager
def seated(page):
    """A page in the driver's seat."""
    with connect(page.url.replace("http", "ws") + "/drive", origin=page.url) as own:
        assert "keys" in json.loads(own.recv(timeout=PATIENCE_S))
        yield own


def say(own, pad=None, key=None):
    own.send(json.dumps({"pad": pad, "key": key}))


def told(own, holds):
    """The news for which that holds; the page hears some while it says that it lives."""
    while True:
        say(own, MIDDLE)
        with suppress(TimeoutError):
            if holds(news := json.loads(own.recv(timeout=0.1))):
                return news


def why_closed(own):
    with pytest.raises(ConnectionClosed) as closed:
        while True:
            own.recv(timeout=PATIENCE_S)
    return closed.value.rcvd.reason


def test_keys_and_the_stick_are_commands_and_every_answer_comes_back(serve):
    stack, page = serve()
    stack.hold_in("DETECT_CONTACT")
    with seated(page) as own:
        say(own, MIDDLE)
        say(own, AHEAD)
        stack.wait_held()
        say(own, MIDDLE)
        stack.wait(lambda: len(stack.commands) == 2)
        say(own, MIDDLE, key="n")
        news = told(own, lambda news: sum(taken is not None for _, taken, _ in news["said"]) == 3)
    assert stack.commands == ["direction 1.00 0.00", "halt", "step"]
    answers = {words: (taken, answer) for words, taken, answer in news["said"]}
    assert answers["halt"] == (True, "after the step of RL; the walk is over")
    assert answers["step"] == (False, "step: the walk ends with this step: commanded halt")
    assert news["state"] == "DETECT_CONTACT" and news["reason"].startswith("leg RL")


def test_a_walk_that_the_stick_leads_is_halted_when_the_page_goes(serve):
    stack, page = serve()
    with seated(page) as own:
        say(own, MIDDLE)
        say(own, AHEAD)
        stack.wait(lambda: stack.commands)
    stack.wait(lambda: stack.commands[1:])
    assert stack.commands == ["direction 1.00 0.00", "halt"]


@pytest.mark.parametrize("leaves", [False, True])
def test_a_robot_that_gets_up_to_walk_stands_when_the_stick_is_let_go_meanwhile(serve, leaves):
    stack, page = serve()
    with seated(page) as own:
        say(own, MIDDLE, key="j")
        stack.come_to("DAMP")
        stack.hold_in("STAND_UP")
        say(own, AHEAD)
        stack.wait_held()
        if not leaves:
            say(own, MIDDLE)
            stack.wait(lambda: stack.commands[2:])
    stack.wait(lambda: stack.commands[2:])
    stack.go_on()
    stack.come_to("STAND")
    assert stack.commands == ["sit", "direction 1.00 0.00", "halt"]


def test_the_heartbeat_is_that_of_a_page_that_is_heard(serve):
    stack, page = serve(heartbeat_s=4.0)
    with seated(page) as own:
        say(own, key="w")  # the first beat as well
        stack.wait(lambda: stack.commands == ["forward"])
        stack.wait(lambda: stack.commands[1:])  # it is there and says nothing, as one that hangs
    assert stack.commands == ["forward", "sit: no heartbeat for 4 s"]


def test_a_page_that_is_silent_loses_the_seat_and_one_that_leaves_gives_it_up(serve):
    _, page = serve(silent_s=1.0)
    with seated(page) as silent:
        assert why_closed(silent) == "the page was not heard for 1 s"
        with seated(page) as other:
            say(other, key="q")
            assert why_closed(other) == "you have left"


def test_one_page_drives_and_another_is_told(serve):
    _, page = serve()
    with seated(page), connect(page.url.replace("http", "ws") + "/drive", origin=page.url) as other:
        assert why_closed(other) == "another page drives this robot"


@pytest.mark.parametrize("origin", ["http://elsewhere.example", "http://127.0.0.1:1", "null", None])
def test_a_page_of_another_site_in_the_same_browser_is_refused(serve, origin):
    stack, page = serve()
    with (
        pytest.raises(InvalidStatus) as refused,
        connect(page.url.replace("http", "ws") + "/drive", origin=origin),
    ):
        pass
    assert refused.value.response.status_code == 403 and not stack.commands


def test_only_this_machine_gets_the_page_and_no_other_may_frame_it(serve):
    _, page = serve()
    port = int(page.url.rpartition(":")[2])
    for path, host, status in (
        ("/", f"localhost:{port}", 200),
        ("/", "rebound.example", 403),
        ("/drive", f"rebound.example:{port}", 403),
        ("/etc/passwd", HOST, 404),
    ):
        call = HTTPConnection(HOST, port, timeout=PATIENCE_S)
        call.request("GET", path, headers={"Host": host, "Origin": f"http://{host}"})
        answer = call.getresponse()
        assert answer.status == status, (path, host)
        if status == 200:
            assert "frame-ancestors 'none'" in answer.headers["Content-Security-Policy"]
            assert answer.headers.get_all("Content-Type") == ["text/html; charset=utf-8"]
        call.close()


def test_a_wrong_call_says_what_would_be_right(capsys, monkeypatch):
    nobody = ["drive", "--namespace", "nobody-is-there"]
    with listen(0) as taken:
        for call, words in (
            (["--port", "8081"], "say --browser as well"),
            (["--browser", "--port", "70000"], "port 70000: there is 1 to 65535"),
            (["--browser", "--port", str(taken.getsockname()[1])], "choose another one, or 0 for any"),
            (["--browser", "--port", "0"], "is `surefoot run` running"),
        ):
            assert main([*nobody, *call]) == 2
            assert words in capsys.readouterr().err
    monkeypatch.setitem(sys.modules, "websockets.sync.server", None)
    monkeypatch.delitem(sys.modules, "surefoot.tools.teleop.drive_page")
    assert main([*nobody, "--browser"]) == 2
    assert "pip install 'surefoot[view]'" in capsys.readouterr().err


def test_the_command_ends_with_the_stack():
    stack = Driven()
    call = [sys.executable, "-P", "-m", "surefoot.tools.cli", "drive", "--browser", "--port", "0"]
    with subprocess.Popen([*call, "--namespace", stack.namespace], stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout.readline().startswith("drive: http://127.0.0.1:")
        stack.close()
        assert "the stack has ended" in process.stdout.read()
    assert process.returncode == 1
