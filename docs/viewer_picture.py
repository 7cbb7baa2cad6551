"""Draws the picture of docs/how_to/view.md: ``python docs/viewer_picture.py`` writes viewer.png beside this file.

Chromium shows the page of ``sarah-view``, in which the robot has just been pushed.
"""

from __future__ import annotations

import re
import shutil
import time
from pathlib import Path

from playwright.sync_api import Page as Tab
from playwright.sync_api import sync_playwright

from sarah.episode.parameter_sets import PARAMETER_SETS
from sarah.runs.run_episodes import RunEpisode
from sarah.viewer.page import Page
from sarah.viewer.server import serving

OUT = Path(__file__).parent / "viewer.png"
WIDTH, HEIGHT = 1440, 900
PATIENCE_MILLISECONDS, SETTLING_SECONDS = 300_000, 5.0


def main() -> None:
    with serving("127.0.0.1", 8080) as server, sync_playwright() as driver:
        episode = RunEpisode("balance", "balance · seed 0", PARAMETER_SETS["balance"].spec)
        page = Page(server, [episode], episode)
        tab = driver.chromium.launch(executable_path=shutil.which("chromium")).new_page(
            viewport={"width": WIDTH, "height": HEIGHT}
        )
        tab.set_default_timeout(PATIENCE_MILLISECONDS)
        tab.goto(f"http://127.0.0.1:{server.get_port()}")
        tab.locator("label").get_by_text("P1", exact=True).wait_for()
        push(tab)
        tab.mouse.move(5, 5)
        time.sleep(SETTLING_SECONDS)
        tab.screenshot(path=OUT)
        page.close()


def push(tab: Tab) -> None:
    """Push the robot, and stop while the push lasts."""
    notice = tab.locator("#webgl-software-rendering button")
    if notice.count():
        notice.click()
    if tab.get_by_role("button", name="Pause").count():
        tab.get_by_role("button", name="Pause").click()
    tab.get_by_role("button", name="Play").wait_for()
    for label, value in (("Force (N)", "80"), ("Direction (°)", "180"), ("Time (s)", "12.2")):
        enter(tab, label, value)
    tab.get_by_text("12.2 s").first.wait_for()
    tab.get_by_role("button", name="Push now").click()
    tab.get_by_role("button", name="Pause").click()
    enter(tab, "Time (s)", "12.35")
    tab.get_by_text(re.compile(r"12\.[34] s")).first.wait_for()


def enter(tab: Tab, label: str, value: str) -> None:
    """Type a number into the field of a slider."""
    name = tab.locator("label").get_by_text(label, exact=True)
    box = name.locator("xpath=ancestor::div[.//input[@type='text']][1]").locator("input[type=text]").first
    box.fill(value)
    box.press("Enter")


if __name__ == "__main__":
    main()
