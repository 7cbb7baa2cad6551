"""Playback by the clock, simulations in the background, and the address of the page."""

import sys
import threading
import time

import psutil
import pytest

from sarah.cli import view
from sarah.control.parameters import PAPER_STEPPING
from sarah.episode.episode import simulate
from sarah.episode.result import EpisodeResult
from sarah.episode.settings import EpisodeConfig
from sarah.episode.spec import EpisodeSpec
from sarah.viewer.background import BackgroundSimulation, Wish
from sarah.viewer.playback import Playback
from sarah.viewer.server import serving


def test_playback_goes_on_by_the_clock_and_stops_at_the_end() -> None:
    shown: list[float] = []
    ended = threading.Event()

    def show(time: float) -> None:
        shown.append(time)
        if time == 3.0:
            ended.set()

    ends: list[float] = []
    playback = Playback(show, lambda: ends.append(shown[-1]))
    playback.load(1.0, 3.0, 2.5)
    playback.speed = 2.0
    began = time.monotonic()
    playback.start()
    playback.play()
    assert ended.wait(10.0) and not ends[1:]
    assert time.monotonic() - began >= 0.25
    assert shown[0] < 2.9 and sorted(shown) == shown and len(shown) > 2
    assert not playback.is_playing
    playback.seek(2.0)
    playback.seek(3.0)
    time.sleep(0.2)
    assert ends == [3.0]  # when the clock came there, not when a user did
    playback.play()
    assert playback.time < 3.0  # from the beginning
    playback.close()


def test_the_newest_wish_is_simulated_and_the_one_before_it_given_up() -> None:
    done: list[EpisodeResult] = []
    finished = threading.Event()
    shares: list[float] = []
    simulation = BackgroundSimulation(shares.append, pytest.fail)
    old, new = (EpisodeSpec(PAPER_STEPPING, 0, config=EpisodeConfig(time_limit=seconds)) for seconds in (30.0, 1.5))
    simulation.request(Wish(old, done.append))
    while not shares:
        time.sleep(0.01)

    def finish(result: EpisodeResult) -> None:
        done.append(result)
        finished.set()

    simulation.request(Wish(new, finish))
    assert finished.wait(60.0)
    assert done == [simulate(new)]


def test_the_page_is_served_to_this_machine_only() -> None:
    with serving(view.ViewOptions().host, view.DEFAULT_PORT) as server:
        listening = [
            connection.laddr
            for connection in psutil.Process().net_connections()
            if connection.status == psutil.CONN_LISTEN
        ]
        assert {address.ip for address in listening} == {"127.0.0.1"}
        assert server.get_port() in {address.port for address in listening}


def test_without_the_extra_the_command_says_what_to_install(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(view, "find_spec", lambda _: None)
    monkeypatch.setattr(sys, "argv", ["sarah-view"])
    with pytest.raises(SystemExit):
        view.main()
    assert capsys.readouterr().err == "sarah-view: error: this needs the extra view: pip install 'sarah[view]'\n"
