"""Draws the pictures of docs/how_to/watch.md: ``python docs/screenshots.py RUNS``, with Chromium and playwright.

RUNS is a folder of trainings that ended, made with ``sarah-train --pictures 20``.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from playwright.sync_api import Page, sync_playwright

HERE = Path(__file__).parent
PORT = 6173
PATIENCE_MILLISECONDS, SETTLING_MILLISECONDS = 120_000, 8_000
ADDRESS = f"http://127.0.0.1:{PORT}/"
TABS = {
    "tensorboard": ("#timeseries", (1100, 760)),
    "tensorboard_images": ("?tagFilter=recommendation%2F%28cycle%7Cvideo%29#timeseries", (1100, 940)),
    "tensorboard_hparams": ("#hparams", (1620, 420)),
}
"""Name of each picture, which page of TensorBoard, and the window's size in pixels."""


def main() -> None:
    command = [Path(sys.executable).with_name("tensorboard"), "--logdir", sys.argv[1], "--port", str(PORT)]
    server = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
    try:
        assert server.stderr is not None
        while f":{PORT}" not in server.stderr.readline():
            pass
        with sync_playwright() as playwright:
            browser = playwright.chromium.launch(executable_path="/usr/bin/chromium", args=["--no-sandbox"])
            for name, (address, (width, height)) in TABS.items():
                page = browser.new_page(viewport={"width": width, "height": height})
                page.set_default_timeout(PATIENCE_MILLISECONDS)
                page.goto(ADDRESS + address, wait_until="networkidle")
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


if __name__ == "__main__":
    main()
