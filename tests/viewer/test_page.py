"""The page in a real browser."""

import base64
import contextlib
import dataclasses
import io
import re
import shutil
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import matplotlib.image
import numpy as np
import pytest
import terminal

from sarah.episode.episode import simulate
from sarah.episode.push import Push
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import BALANCE, BalanceConfig
from sarah.operation.settings import OperationConfig
from sarah.pictures.colours import LEFT, PHASE_COLOURS, PUSH, RIGHT
from sarah.runs.config import TrainingConfig
from sarah.runs.run_episodes import episodes_of_run
from sarah.runs.run_folder import RunFolder
from sarah.runs.session import SessionSpec
from sarah.runs.session_folder import SessionFolder
from sarah.training.operate import operate
from sarah.viewer.scenario import Scenario
from sarah.viewer.scene import channels, describe_tick

CHROMIUM = shutil.which("chromium")
SOFTWARE_WEBGL = ["--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
PATIENCE = 120_000
"""Milliseconds; a busy machine without a GPU draws less than one picture a second."""
CONFIG = BalanceConfig(time_limit=6.0, push=Push(newtons=(40.0, 60.0), at_seconds=(2.0, 3.0)))
TRIED = ((0.0, 0.0, 0.0, 0.0), (1.0, 0.0, 0.5, 0.0), (-2.0, 1.0, 0.0, 2.0))
LEARNED = (0.8, 0.1, 0.3, -0.1)


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> RunFolder:
    """A training of three episodes."""
    path = tmp_path_factory.mktemp("runs") / "balance"
    run = RunFolder.create(path, TrainingConfig(task="balance", episodes=3, episode=CONFIG))
    for index, parameters in enumerate(TRIED):
        spec = EpisodeSpec(parameters, 2**31 + index, "balance", CONFIG)
        result = simulate(spec)
        run.append_episode(index, spec, result)
    run.write_parameters({"parameters": dict(zip(BALANCE.parameter_names, LEARNED, strict=True))})
    return run


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    playwright = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    if CHROMIUM is None:
        pytest.skip("chromium is not installed (on Debian: apt-get install chromium)")
    with playwright.sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=CHROMIUM, args=SOFTWARE_WEBGL)
        yield browser
        browser.close()


@contextlib.contextmanager
def page_of(browser: Any, *arguments: str | Path) -> Iterator[Any]:
    server = subprocess.Popen([terminal.BIN / "sarah-view", *arguments], stdout=subprocess.PIPE, text=True)
    try:
        assert server.stdout is not None
        url = re.search(r"http://127\.0\.0\.1:\d+", server.stdout.readline())
        assert url
        page = browser.new_page(viewport={"width": 1000, "height": 500})
        page.set_default_timeout(PATIENCE)
        page.goto(url[0])
        page.locator("#results").get_by_text("before").wait_for(state="attached")
        yield page
    finally:
        server.terminate()
        server.wait(30)


@pytest.fixture(scope="module")
def page(browser: Any, run: RunFolder) -> Iterator[Any]:
    """The page of the run, with its first episode."""
    with page_of(browser, run.path) as page:
        field(page, "Show").click()
        page.get_by_role("option").get_by_text("2 s", exact=True).click()
        field(page, "Speed").click()  # no episode ends before a test has looked at it
        page.get_by_role("option").get_by_text("1/10").click()
        yield page


def picture(page: Any) -> np.ndarray:
    """What WebGL has drawn: uint8 of shape (height, width, 3)."""
    url = page.evaluate("document.querySelector('canvas[data-engine]').toDataURL('image/png')")
    pixels = matplotlib.image.imread(io.BytesIO(base64.b64decode(url.split(",")[1])))
    return np.asarray(255 * pixels[:, :, :3]).astype(int)


def share(pixels: np.ndarray, red: int, green: int, blue: int, tolerance: int = 30) -> float:
    """Share of the pixels whose channels differ from one another as those of a colour do, however it is lit."""
    difference = pixels - pixels.mean(axis=2, keepdims=True)
    wanted = np.array([red, green, blue]) - np.mean([red, green, blue])
    alike = (difference * wanted).sum(axis=2) > 0.9 * np.linalg.norm(wanted) * np.linalg.norm(difference, axis=2)
    return float((alike & (np.linalg.norm(difference, axis=2) > tolerance)).mean())


def eventually(condition: Any, seconds: float = PATIENCE / 1000) -> None:
    deadline = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < deadline, "waited in vain"
        time.sleep(0.2)


def field(page: Any, label: str) -> Any:
    return _row(page, label, "input[not(@type='hidden')]").locator("input:not([type=hidden])").first


def enter(page: Any, label: str, value: str) -> None:
    field(page, label).fill(value)
    field(page, label).press("Enter")


def slider(page: Any, label: str) -> Any:
    return _row(page, label, "*[@role='slider']").get_by_role("slider")


def _row(page: Any, label: str, content: str) -> Any:
    """The smallest box that holds a label and what stands beside it."""
    return page.locator("label").get_by_text(label, exact=True).locator(f"xpath=ancestor::div[.//{content}][1]")


def scores(page: Any) -> list[str]:
    row = page.locator("#results tr").filter(has=page.get_by_text("score", exact=True))
    return row.locator("td").all_inner_texts()[1:]


def choose_on_page(page: Any, text: str) -> None:
    field(page, "Episode").click()
    page.get_by_role("option").get_by_text(re.compile(f"^{text}")).click()
    page.get_by_role("button", name="Back to this episode").click()  # plays it, even if it was chosen before


def chosen(page: Any, run: RunFolder, index: int) -> tuple[EpisodeSpec, str]:
    """An episode that the page shows, and its score there."""
    choose_on_page(page, f"episode {index}")
    choice = next(choice for choice in episodes_of_run(run) if choice.name == f"{index}")
    eventually(lambda: scores(page)[0] == f"{choice.score:.3f}")
    return choice.spec, f"{choice.score:.3f}"


def pause(page: Any) -> None:
    page.get_by_role("button", name="Pause").click()
    page.get_by_role("button", name="Play").wait_for()


def go_to(page: Any, seconds: float) -> None:
    status = page.get_by_text(re.compile(r"^\d+\.\d s · "))

    def typed_and_shown() -> bool:
        # Typed again if need be: a page that draws less than once a second loses what is typed between two drawings.
        enter(page, "Time (s)", str(seconds))
        page.wait_for_timeout(2000)
        return abs(float(status.first.inner_text().split()[0]) - seconds) < 0.1

    eventually(typed_and_shown)


def has_plots_of(page: Any, moment: float, window: float) -> bool:
    """Whether all plots show one window of time, with their line at a moment."""
    ranges = page.evaluate(
        "() => Object.values(window.__viserTestpoints.uplots).map(({chart}) => {"
        "const left = parseFloat(getComputedStyle(chart.over, '::after').left) / chart.over.clientWidth;"
        "return [chart.scales.x.min, chart.scales.x.max, left]})"
    )
    first, last, left = ranges[0]
    is_there = first <= moment <= last and abs(last - first - window) < 0.02
    return is_there and ranges == [ranges[0]] * 6 and abs(first + left * (last - first) - moment) < 0.05


def test_the_robot_is_drawn_with_a_blue_and_a_red_leg(page: Any) -> None:
    eventually(lambda: min(share(picture(page), *channels(LEFT)), share(picture(page), *channels(RIGHT))) > 0.004)
    pixels = picture(page)
    difference = pixels[:, :, 2] - pixels[:, :, 0]
    blue, red = ((sign * difference > 40).nonzero()[1].mean() for sign in (1, -1))
    assert blue > red  # the camera looks at the robot's front, so its left leg is on the right


def test_an_episode_plays(page: Any) -> None:
    def shown() -> float:
        return float(field(page, "Time (s)").input_value())

    page.get_by_role("button", name="Back to this episode").click()
    eventually(lambda: shown() < 2.0)
    begin = shown()
    eventually(lambda: begin + 0.2 < shown())
    pause(page)
    paused = shown()
    time.sleep(1.0)
    assert shown() == paused


def test_scrubbing_shows_that_moment_in_scene_and_plots(page: Any, run: RunFolder) -> None:
    choose_on_page(page, "learned")
    result = simulate(episodes_of_run(run)[0].spec, record_trace=True)
    trace = result.trace
    assert trace is not None
    eventually(lambda: scores(page)[0] == f"{result.score:.3f}")
    pause(page)
    for phase in ("lift", "land"):
        tick = next(tick for tick in range(300, len(trace)) if set(trace.phase[tick - 1 : tick + 2]) == {phase})
        moment = float(trace.time[tick])
        go_to(page, round(moment, 2))
        for line in describe_tick(trace, tick):
            page.get_by_text(line, exact=False).first.wait_for()
        eventually(lambda phase=phase: share(picture(page), *channels(PHASE_COLOURS[phase])) > 0.002)
        eventually(lambda moment=moment: has_plots_of(page, moment, 2.0))


def test_what_is_changed_is_simulated_beside_the_old_score(page: Any, run: RunFolder) -> None:
    spec, old = chosen(page, run, 1)
    scenario = Scenario.of(spec)
    slider(page, "P1").press("End")
    new = f"{simulate(dataclasses.replace(scenario, stepping=(2.0, *scenario.stepping[1:])).spec()).score:.3f}"
    assert new != old
    eventually(lambda: scores(page) == [new, old])
    page.get_by_role("button", name="Back to this episode").click()
    eventually(lambda: scores(page) == [old, new])
    enter(page, "Bumps (mm)", "20")
    enter(page, "Slope (°)", "8")
    terrain = dataclasses.replace(scenario.terrain, roughness=(0.02, 0.02), slope_degrees=(8.0, 8.0))
    rough = f"{simulate(dataclasses.replace(scenario, terrain=terrain).spec()).score:.3f}"
    eventually(lambda: scores(page)[0] == rough)


def test_a_push_is_simulated_and_drawn_as_an_arrow(page: Any, run: RunFolder) -> None:
    _, old = chosen(page, run, 0)
    page.get_by_role("button", name="No push").click()
    eventually(lambda: scores(page)[1] == old)
    calm = scores(page)[0]
    pause(page)
    go_to(page, 4.0)
    assert share(picture(page), *channels(PUSH)) < 0.0005
    enter(page, "Force (N)", "150")
    page.get_by_role("button", name="Push now").click()
    eventually(lambda: scores(page)[1] == calm and scores(page)[0] != calm)
    pause(page)
    go_to(page, 4.1)
    eventually(lambda: has_plots_of(page, 4.1, 2.0))
    eventually(lambda: share(picture(page), *channels(PUSH)) > 0.002)


def test_a_session_plays_on_from_window_to_window(browser: Any, tmp_path: Path) -> None:
    config = OperationConfig(minutes=0.1, settle_seconds=0.5, measure_seconds=1.5)
    spec = SessionSpec(learner="none", config=config)
    operate(SessionFolder.create(tmp_path / "session", spec), spec)
    with page_of(browser, tmp_path / "session", "--which", "0") as page:
        eventually(lambda: field(page, "Episode").input_value().startswith("window 2"))
        page.get_by_text(re.compile(r"^[567]\.\d s · ")).first.wait_for()  # time of operation


def test_an_exported_episode_plays_without_server_and_network(browser: Any, run: RunFolder, tmp_path: Path) -> None:
    file = tmp_path / "scene.html"
    exported = terminal.run("sarah-view", str(run.path), "--which", "best", "--out", str(file), cwd=tmp_path)
    assert exported.stdout == f"{file}\n"
    context = browser.new_context(viewport={"width": 500, "height": 400}, offline=True)
    requests: list[str] = []
    context.on("request", lambda request: requests.append(request.url))
    page = context.new_page()
    page.set_default_timeout(PATIENCE)
    page.goto(file.as_uri())
    page.wait_for_selector("canvas[data-engine]")
    eventually(lambda: min(share(picture(page), *channels(LEFT)), share(picture(page), *channels(RIGHT))) > 0.004)
    before = picture(page)
    eventually(lambda: (np.abs(picture(page) - before).max(axis=2) > 40).mean() > 0.001)
    assert [url for url in requests if not url.startswith(("file:", "data:", "blob:"))] == []
    context.close()
