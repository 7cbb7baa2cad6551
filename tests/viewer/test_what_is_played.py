"""What the page plays: an episode as its sliders make it, by the clock; and what its table leaves out."""

import time
from dataclasses import replace
from pathlib import Path
from queue import Queue

import psutil
import pytest
from laboratory import COARSE_PHYSICS, RESULT
from logged import write
from terminal import run

from sarah import BALANCE, STEPPING, BalanceConfig, DrawnPush, EpisodeConfig, EpisodeResult, EpisodeSpec, Push, simulate
from sarah.cli import view
from sarah.control.parameters import PAPER_STEPPING
from sarah.episode.task_answers import push_of
from sarah.logs.played import LoggedResult, played
from sarah.robot.description import describe_robot
from sarah.simulation.terrain import Terrain, draw_ground
from sarah.viewer.background import BackgroundSimulation, Wish
from sarah.viewer.playback import Playback
from sarah.viewer.results import comparison
from sarah.viewer.scenario import Scenario
from sarah.viewer.server import serving

PUSHED = BalanceConfig(time_limit=4.0, push=Push(newtons=(40.0, 60.0), at_seconds=(2.0, 3.0)), physics=COARSE_PHYSICS)
LEARNED = (0.8, 0.1, 0.3, -0.1)


def test_sliders_that_stand_still_change_nothing() -> None:
    stepping = EpisodeSpec(PAPER_STEPPING, 3, config=EpisodeConfig(time_limit=3.0, physics=COARSE_PHYSICS))
    assert simulate(Scenario.of(stepping).spec()) == simulate(stepping)
    pushed = EpisodeSpec(LEARNED, 3, "balance", PUSHED)
    again = simulate(Scenario.of(pushed).spec())
    # The push goes by degrees and back, which costs a bit of precision.
    assert again.score == pytest.approx(simulate(pushed).score, abs=0.02) and again.duration == 4.0


def test_ground_that_was_drawn_stays_with_still_sliders() -> None:
    terrain = Terrain((0.0, 6.0), roughness=(0.0, 0.01), cell=(0.04, 0.08), friction_right=(0.3, 0.6))
    spec = EpisodeSpec(PAPER_STEPPING, 3, config=EpisodeConfig(time_limit=2.0, terrain=terrain))
    scenario = Scenario.of(spec)
    assert draw_ground(scenario.terrain, 3) == draw_ground(terrain, 3)
    assert simulate(scenario.spec()) == simulate(spec)


def test_sliders_leave_reward_and_ending_of_an_own_task() -> None:
    ends = {"reward": lambda *_: 2.0, "best_reward": 4.0, "ending": lambda *_: "tired"}
    own = replace(STEPPING, **ends)  # type: ignore[arg-type]
    result = simulate(Scenario.of(EpisodeSpec(PAPER_STEPPING, 3, own)).spec())
    assert result.termination == "tired" and result.episode_return == pytest.approx(2.0 * 0.01)
    assert result.score == pytest.approx(result.episode_return / (4.0 * 29.0))


def test_a_push_is_simulated_as_given_and_lasts_as_its_task_says() -> None:
    lasting = replace(BALANCE, draw_push=lambda config, seed: DrawnPush((40.0, 0.0, 0.0), 2.0, 0.6))
    found = Scenario.of(EpisodeSpec(LEARNED, 0, lasting, PUSHED)).spec().config
    assert push_of(BALANCE, found, 0) == DrawnPush((40.0, 0.0, 0.0), 2.0, 0.6)
    push, config = Push((50.0, 50.0), (90.0, 90.0), (2.5, 2.5)), replace(PUSHED, time_limit=3.0)
    scenario = Scenario(PAPER_STEPPING, LEARNED, push, Terrain(), 1, config)
    trace = simulate(scenario.spec(), record_trace=True).trace
    assert trace is not None
    assert trace.push[trace.tick_at(2.55)] == pytest.approx([0.0, 50.0, 0.0])
    assert not trace.push[trace.tick_at(2.49)].any()


def test_what_nobody_knows_of_a_logged_robot_is_not_shown(tmp_path: Path) -> None:
    pytest.importorskip("viser")
    from sarah.viewer.scene import describe_tick

    logged = LoggedResult(**vars(RESULT))
    table = comparison(logged, RESULT, None)
    assert "<td>score</td><td><b></b></td><td>0.800</td>" in table
    assert "<td>steps per second</td><td><b>3.00</b></td><td>3.00</td>" in table
    trace = played(write(tmp_path / "a.mcap"), describe_robot()).trace
    assert trace is not None and describe_tick(trace, 50)[1] == "4.0 steps/s"


def test_playback_goes_on_by_the_clock_and_stops_at_the_end() -> None:
    shown: list[float] = []
    ends: Queue[float] = Queue()
    playback = Playback(shown.append, lambda: ends.put(shown[-1]))
    playback.load(1.0, 3.0, 2.5)
    playback.speed = 2.0
    began = time.monotonic()
    playback.start()
    playback.play()
    assert ends.get(timeout=10.0) == 3.0 and time.monotonic() - began >= 0.25
    assert shown[0] < 2.9 and sorted(shown) == shown and len(shown) > 2 and not playback.is_playing
    playback.seek(2.0)
    playback.seek(3.0)
    time.sleep(0.2)
    assert ends.empty()  # the clock did not come there, but a user
    playback.play()
    assert playback.time < 3.0  # from the beginning
    playback.close()


def test_the_newest_wish_is_simulated_and_older_ones_given_up() -> None:
    done: Queue[EpisodeResult] = Queue()
    shares: Queue[float] = Queue()
    simulation = BackgroundSimulation(shares.put, pytest.fail)
    old, new = (EpisodeSpec(PAPER_STEPPING, 0, config=EpisodeConfig(time_limit=seconds)) for seconds in (30.0, 1.5))
    simulation.request(Wish(old, done.put))
    shares.get(timeout=60.0)
    simulation.request(Wish(new, done.put))
    assert done.get(timeout=60.0) == simulate(new)


def test_the_page_is_served_to_this_machine_only() -> None:
    with serving(view.ViewOptions().host, view.DEFAULT_PORT) as server:
        connections = psutil.Process().net_connections()
        listening = [connection.laddr for connection in connections if connection.status == psutil.CONN_LISTEN]
        assert {address.ip for address in listening} == {"127.0.0.1"}
        assert server.get_port() in {address.port for address in listening}


def test_without_the_extra_the_command_says_what_to_install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(view, "find_spec", lambda _: None)
    said = run("sarah-view", cwd=tmp_path).stderr
    assert said == "sarah-view: error: this needs the extra view: pip install '.[view]' in the clone\n"
