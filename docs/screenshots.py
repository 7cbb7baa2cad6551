"""Draws the pictures of pages in a browser, with Chromium and playwright: ``python docs/screenshots.py [RUNS]``.

Without RUNS, that of docs/how_to/view.md: the page of ``sarah-view``, in which the robot has just been pushed. With it,
those of docs/how_to/watch.md; RUNS is a folder of trainings that ended, made with ``sarah-train --pictures 20``.
"""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from pathlib import Path

from playwright.sync_api import Browser, Page, sync_playwright

from sarah.episode.parameter_sets import PARAMETER_SETS
from sarah.runs.run_episodes import RunEpisode
from sarah.viewer import page as viewer
from sarah.viewer.server import serving

HERE = Path(__file__).parent
PORT = 6173
PATIENCE_MILLISECONDS, SETTLING_MILLISECONDS = 300_000, 8_000
ADDRESS = f"http://127.0.0.1:{PORT}/"
TABS = {
    "tensorboard": ("#timeseries", (1100, 760)),
    "tensorboard_images": ("?tagFilter=recommendation%2F%28cycle%7Cvideo%29#timeseries", (1100, 940)),
    "tensorboard_hparams": ("#hparams", (1620, 420)),
}
"""Name of each picture, which page of TensorBoard, and the window's size in pixels."""


def main() -> None:
    with sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=shutil.which("chromium"), args=["--no-sandbox"])
        if sys.argv[1:]:
            draw_tensorboard(browser, sys.argv[1])
        else:
            draw_viewer(browser)


def opened(browser: Browser, address: str, size: tuple[int, int]) -> Page:
    """Open a page in a window of some pixels."""
    width, height = size
    page = browser.new_page(viewport={"width": width, "height": height})
    page.set_default_timeout(PATIENCE_MILLISECONDS)
    page.goto(address)
    return page


def draw_tensorboard(browser: Browser, runs: str) -> None:
    """Draw what TensorBoard shows of some trainings."""
    command = [str(Path(sys.executable).with_name("tensorboard")), "--logdir", runs, "--port", str(PORT)]
    server = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
    try:
        assert server.stderr is not None
        while f":{PORT}" not in server.stderr.readline():
            pass
        for name, (address, size) in TABS.items():
            page = opened(browser, ADDRESS + address, size)
            page.wait_for_load_state("networkidle")
            shoot(page, HERE / f"{name}.png")
            page.close()
    finally:
        server.terminate()


def shoot(page: Page, path: Path) -> None:
    """Close the settings, and wait until nothing is loading any more."""
    if page.url.endswith("#timeseries"):
        page.locator('button[aria-label="Close side pane"]').click()
    page.wait_for_timeout(2000)
    page.wait_for_function("document.querySelectorAll('mat-spinner, .mat-mdc-progress-spinner').length == 0")
    page.wait_for_timeout(SETTLING_MILLISECONDS)  # curves are drawn a while after they have come
    page.screenshot(path=path)


def draw_viewer(browser: Browser) -> None:
    """Draw the viewer's page while a push lasts."""
    with serving("127.0.0.1", 8080) as server:
        episode = RunEpisode("balance", "balance · seed 0", PARAMETER_SETS["balance"].spec)
        shown = viewer.Page(server, [episode], episode)
        page = opened(browser, f"http://127.0.0.1:{server.get_port()}", (1440, 900))
        page.locator("label").get_by_text("P1", exact=True).wait_for()
        push(page)
        page.mouse.move(5, 5)
        page.wait_for_timeout(SETTLING_MILLISECONDS)
        page.screenshot(path=HERE / "viewer.png")
        shown.close()


def push(page: Page) -> None:
    """Push the robot, and stop while the push lasts."""
    notice = page.locator("#webgl-software-rendering button")
    if notice.count():
        notice.click()
    if page.get_by_role("button", name="Pause").count():
        page.get_by_role("button", name="Pause").click()
    page.get_by_role("button", name="Play").wait_for()
    for label, value in (("Force (N)", "80"), ("Direction (°)", "180"), ("Time (s)", "12.2")):
        enter(page, label, value)
    page.get_by_text("12.2 s").first.wait_for()
    page.get_by_role("button", name="Push now").click()
    page.get_by_role("button", name="Pause").click()
    enter(page, "Time (s)", "12.35")
    page.get_by_text(re.compile(r"12\.[34] s")).first.wait_for()


def enter(page: Page, label: str, value: str) -> None:
    """Type a number into the field of a slider."""
    name = page.locator("label").get_by_text(label, exact=True)
    box = name.locator("xpath=ancestor::div[.//input[@type='text']][1]").locator("input[type=text]").first
    box.fill(value)
    box.press("Enter")


if __name__ == "__main__":
    main()
