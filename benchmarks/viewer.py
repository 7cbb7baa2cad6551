"""How fast is the viewer?

How soon its page is there, and how many frames per second it plays. Frames are counted where they are sent, and where
Chromium draws them. Without a graphics card it draws on the processor, which says little of a browser that has one;
the page's own work on a frame is the same with either.
"""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
import threading
import time
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import playwright.sync_api as playwright
from pandas import DataFrame

from benchmarks.timing import Timing
from experiments.experiment import EPISODE
from experiments.record import Row
from experiments.tables import table
from sarah.episode.episode import simulate
from sarah.runs.run_episodes import RunEpisode, episode_of_parameters
from sarah.viewer.page import Page
from sarah.viewer.server import serving

PARAMETERS = (1.06, -0.24, 0.21, -0.15)
HOST, PORT = "127.0.0.1", 8080
WINDOWS = ((1440, 900), (640, 400))
"""Sizes of the browser's window, in pixels."""
PATIENCE_MILLISECONDS = 300_000
COUNT_DRAWN = """seconds => new Promise(resolve => {
    let drawn = 0;
    const begin = performance.now();
    const frame = () => ++drawn && performance.now() - begin < 1000 * seconds
        ? requestAnimationFrame(frame) : resolve(drawn / seconds);
    requestAnimationFrame(frame);
})"""


@dataclass(frozen=True)
class Viewer(Timing):
    """Start of the page, and its frames.

    :param rounds: number of times that everything is measured
    :param seconds: time over which frames are counted, in s
    """

    depends_on = (*EPISODE, "sarah/viewer")
    rounds: int = 3
    seconds: float = 10.0

    def cases(self) -> list[Row]:
        """One for all, as everything is measured on the same page."""
        return [{}]

    def rows(self) -> Iterator[Row]:
        """A row for each quantity."""
        measured = [self._round() for _ in range(self.rounds)]
        for quantity in measured[0]:
            values = [one[quantity] for one in measured]
            yield {"quantity": quantity, "lowest": min(values), "highest": max(values)}

    def _round(self) -> dict[str, float]:
        figures = {"seconds from the command until the page is there": seconds_until_served()}
        with serving(HOST, PORT) as server:
            episode = episode_of_parameters(PARAMETERS)
            page = Page(server, [episode], episode)
            page.begin()
            while not page.frames:
                time.sleep(0.01)
            figures["frames per second sent"] = frames_per_second(page, self.seconds)
            with simulating(episode):
                while_simulating = frames_per_second(page, self.seconds)
            figures["frames per second sent while the next episode is simulated"] = while_simulating
            with playwright.sync_playwright() as driver:
                browser = driver.chromium.launch(executable_path=shutil.which("chromium"))
                for width, height in WINDOWS:
                    tab = browser.new_page(viewport={"width": width, "height": height})
                    drawn, milliseconds = self._drawn(tab, f"http://{HOST}:{server.get_port()}")
                    tab.close()
                    size = f"{width} x {height} pixels"
                    figures[f"frames per second drawn by Chromium without a graphics card, {size}"] = round(drawn)
                    figures[f"milliseconds of the page's own work a frame, {size}"] = round(milliseconds)
            page.close()
        return figures

    def _drawn(self, tab: playwright.Page, address: str) -> tuple[float, float]:
        """Frames per second that the browser draws, and milliseconds of the page's own work for each."""
        tab.set_default_timeout(PATIENCE_MILLISECONDS)
        tab.goto(address)
        tab.locator("label").get_by_text("P1", exact=True).wait_for()
        tab.get_by_role("button", name="Back to this episode").click()
        performance = tab.context.new_cdp_session(tab)
        performance.send("Performance.enable")
        before = seconds_of_the_page(performance)
        drawn = float(tab.evaluate(COUNT_DRAWN, self.seconds))
        spent = seconds_of_the_page(performance) - before
        return drawn, 1000.0 * spent / (drawn * self.seconds)


def seconds_until_served() -> float:
    """Seconds from the command to a page that has been loaded."""
    start = time.perf_counter()
    command = Path(sys.executable).with_name("sarah-view")
    process = subprocess.Popen([command], stdout=subprocess.PIPE, text=True)
    try:
        assert process.stdout is not None
        urls = (re.search(r"http://\S+", line) for line in process.stdout)
        url = next(url for url in urls if url)
        urllib.request.urlopen(url[0]).read()
        return time.perf_counter() - start
    finally:
        process.terminate()
        process.wait(30)


@contextmanager
def simulating(episode: RunEpisode) -> Iterator[None]:
    """Simulate an episode again and again, in a thread, as the page does when somebody moves a slider.

    :param episode: the episode
    """
    done = threading.Event()

    def run() -> None:
        while not done.is_set():
            simulate(episode.spec, record_trace=True)

    thread = threading.Thread(target=run)
    thread.start()
    try:
        yield
    finally:
        done.set()
        thread.join()


def frames_per_second(page: Page, seconds: float) -> float:
    """Frames that are sent.

    :param page: the page
    :param seconds: time over which they are counted, in s
    """
    frames, start = page.frames, time.perf_counter()
    time.sleep(seconds)
    return (page.frames - frames) / (time.perf_counter() - start)


def seconds_of_the_page(performance: playwright.CDPSession) -> float:
    """Seconds of script, layout and style so far: what a frame costs whoever rasterises it.

    :param performance: session of the browser's developer tools
    """
    values = {metric["name"]: metric["value"] for metric in performance.send("Performance.getMetrics")["metrics"]}
    return sum(values[name] for name in ("ScriptDuration", "LayoutDuration", "RecalcStyleDuration"))


FULL = Viewer()
QUICK = Viewer(rounds=1, seconds=1.0)


def speeds(rows: DataFrame) -> str:
    """All that was measured."""
    return table(rows, ["quantity", "lowest", "highest"], "The page of `sarah-view`.", lowest=".1f", highest=".1f")
