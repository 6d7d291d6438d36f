"""The page in a real browser, and what goes wrong before there is one."""

import socket
import sys
import threading
import time

import pytest
import scenes
import viser
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

from surefoot.tools.cli import main
from surefoot.tools.view.page import CORE_SHARE, HOST, Page, draw_period_s
from surefoot.tools.view.recording_source import RecordingSource

PATIENCE_S = 120.0  # of wall time: other jobs share the cores, and no test is decided by it
PICTURE = {
    "x": 0,
    "y": 200,
    "width": 500,
    "height": 300,
}  # left of the panel, below what viser says of the browser


@pytest.fixture
def page():
    source = RecordingSource(scenes.path("probe_holds"), from_t=7.2)
    source.playing = False
    page, over = Page(source, port=0), threading.Event()
    thread = threading.Thread(target=page.run, args=(over.is_set,))
    thread.start()
    yield page, source
    over.set()
    thread.join()
    page.close()


def test_pictures_that_take_much_of_a_core_are_fewer():
    assert draw_period_s(0.0) == draw_period_s(0.004) == 0.1
    assert draw_period_s(0.03) == pytest.approx(0.03 / CORE_SHARE)
    assert draw_period_s(5.0) == 1.0  # a page that has just been opened still shows something


def wait(holds):
    end = time.monotonic() + PATIENCE_S
    while not holds():
        assert time.monotonic() < end
        time.sleep(0.1)


def test_the_page_shows_the_robot_and_what_it_is_at_and_a_browser_that_leaves_ends_nothing(page, tab, tmp_path):
    page, source = page
    requested = []
    tab.on("request", lambda request: requested.append(request.url))
    tab.goto(page.url)
    tab.get_by_text("PROBE", exact=True).wait_for()
    tab.get_by_text("displacement").wait_for()
    assert tab.get_by_text("Tuning", exact=True).count() == 0  # a recording cannot be tuned
    wait(lambda: tab.screenshot(clip=PICTURE) == tab.screenshot(clip=PICTURE))  # all that comes in has come in
    before = tab.screenshot(clip=PICTURE, path=tmp_path / "before.png")
    tab.get_by_role("button", name="play").click()
    wait(lambda: source.t == source.end_t)
    wait(lambda: tab.screenshot(clip=PICTURE, path=tmp_path / "after.png") != before)
    assert all(url.startswith((page.url, "data:", "blob:")) for url in requested), requested
    tab.close()
    source.seek(7.2)
    wait(lambda: source.heard.t == pytest.approx(7.2, abs=0.01))


def test_a_page_of_another_site_in_the_same_browser_is_refused(page):
    page, _ = page
    call = {"subprotocols": [f"viser-v{viser.__version__}"], "max_size": None}
    address = page.url.replace("http", "ws")
    with connect(address, origin=page.url, **call) as own:
        assert own.recv(timeout=PATIENCE_S)
    with connect(address, origin="http://elsewhere.example", **call) as strange, pytest.raises(ConnectionClosed):
        strange.recv(timeout=PATIENCE_S)


def test_a_port_that_is_taken_is_named_with_its_remedy(capsys):
    with socket.socket() as taken:
        taken.bind((HOST, 0))
        taken.listen()
        port = taken.getsockname()[1]
        for call in (["view", str(scenes.path("step"))], ["run", "flat", "--view"]):
            words = "--port" if call[0] == "view" else "--view-port"
            assert main([*call, words, str(port)]) == 2
            told = capsys.readouterr().err
            assert f"port {port}" in told and "choose another one" in told


def test_without_its_package_it_says_which_one_brings_it(capsys, monkeypatch):
    monkeypatch.setitem(sys.modules, "viser", None)
    for name in [name for name in sys.modules if name.startswith("surefoot.tools.view.")]:
        monkeypatch.delitem(sys.modules, name)
    assert main(["view", str(scenes.path("step"))]) == 2
    assert "pip install 'surefoot[view]'" in capsys.readouterr().err
