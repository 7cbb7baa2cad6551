"""How soon the viewer's page is there, and how many frames per second it plays; with a screenshot on request.

Frames are counted where they are sent, and where Chromium draws them. Without a GPU it draws on the processor, which
says little of a browser that has one; what the page's script, layout and style take of a frame is the same with either.
"""

from __future__ import annotations

import argparse
import re
import shutil
import subprocess
import sys
import time
import urllib.request
from pathlib import Path

import playwright.sync_api as playwright

from sarah.runs.run_episodes import choice_of_parameters
from sarah.viewer.page import Page
from sarah.viewer.server import serving

COMMAND = Path(sys.executable).parent / "sarah-view"
PARAMETERS = (1.06, -0.24, 0.21, -0.15)
SECONDS = 10.0
"""Over which frames are counted."""
COUNT_DRAWN = """seconds => new Promise(resolve => {
    let drawn = 0;
    const begin = performance.now();
    const frame = () => ++drawn && performance.now() - begin < 1000 * seconds
        ? requestAnimationFrame(frame) : resolve(drawn / seconds);
    requestAnimationFrame(frame);
})"""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--screenshot", type=Path, help="PNG to write")
    parser.add_argument("--size", type=int, nargs=2, default=(1440, 900), help="of the browser's window, in pixels")
    options = parser.parse_args()
    print(f"{seconds_until_served():.1f} s from the command to a page that can be loaded")
    with serving("127.0.0.1", 8080) as server:
        choice = choice_of_parameters(PARAMETERS)
        page = Page(server, [choice], choice)
        while not page.frames:
            time.sleep(0.01)
        print(f"{frames_per_second(page):.1f} frames per second are sent")
        with playwright.sync_playwright() as driver:
            browser = driver.chromium.launch(executable_path=shutil.which("chromium"))
            tab = browser.new_page(viewport={"width": options.size[0], "height": options.size[1]})
            tab.set_default_timeout(300_000)
            start = time.perf_counter()
            tab.goto(f"http://127.0.0.1:{server.get_port()}")
            tab.locator("label").get_by_text("P1", exact=True).wait_for()
            print(f"{time.perf_counter() - start:.1f} s until Chromium has loaded the page")
            tab.get_by_role("button", name="Back to this episode").click()
            performance = tab.context.new_cdp_session(tab)
            performance.send("Performance.enable")
            before = seconds_of_the_page(performance)
            drawn = tab.evaluate(COUNT_DRAWN, SECONDS)
            print(f"{drawn:.1f} frames per second are drawn")
            spent = seconds_of_the_page(performance) - before
            print(f"{1000 * spent / (drawn * SECONDS):.0f} ms of a frame are the page's script, layout and style")
            if options.screenshot:
                take_screenshot(tab, options.screenshot)
        page.close()


def seconds_until_served() -> float:
    start = time.perf_counter()
    process = subprocess.Popen([COMMAND], stdout=subprocess.PIPE, text=True)
    try:
        assert process.stdout is not None
        url = re.search(r"http://\S+", process.stdout.readline())
        assert url
        urllib.request.urlopen(url[0]).read()
        return time.perf_counter() - start
    finally:
        process.terminate()
        process.wait(30)


def frames_per_second(page: Page) -> float:
    frames, start = page.frames, time.perf_counter()
    time.sleep(SECONDS)
    return (page.frames - frames) / (time.perf_counter() - start)


def seconds_of_the_page(performance: playwright.CDPSession) -> float:
    """Seconds of script, layout and style so far: what a frame costs whoever rasterises it."""
    values = {metric["name"]: metric["value"] for metric in performance.send("Performance.getMetrics")["metrics"]}
    return sum(values[name] for name in ("ScriptDuration", "LayoutDuration", "RecalcStyleDuration"))


def take_screenshot(tab: playwright.Page, path: Path) -> None:
    """The robot while it is pushed."""
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
    tab.mouse.move(5, 5)
    time.sleep(5.0)
    tab.screenshot(path=path)


def enter(tab: playwright.Page, label: str, value: str) -> None:
    name = tab.locator("label").get_by_text(label, exact=True)
    box = name.locator("xpath=ancestor::div[.//input[@type='text']][1]").locator("input[type=text]").first
    box.fill(value)
    box.press("Enter")


if __name__ == "__main__":
    main()
