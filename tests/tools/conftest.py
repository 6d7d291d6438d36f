"""A real browser without a screen or a GPU."""

import shutil

import pytest

CHROMIUM = shutil.which("chromium")
FLAGS = [
    *("--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking"),
    *("--disable-component-update", "--disable-sync"),
    *("--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"),  # WebGL without a GPU
]
PATIENCE_S = 120.0  # of wall time: other jobs share the cores, and no test is decided by it


@pytest.fixture(scope="session")
def browser():
    """Chromium, where there is one."""
    if CHROMIUM is None:
        pytest.skip("no chromium on this machine: apt-get install chromium")
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        yield browser
        browser.close()


@pytest.fixture
def tab(browser):
    """A small window: every pixel is drawn by the processor."""
    tab = browser.new_page(viewport={"width": 900, "height": 500})
    tab.set_default_timeout(1e3 * PATIENCE_S)
    yield tab
    tab.close()
