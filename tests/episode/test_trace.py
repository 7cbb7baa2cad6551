"""What a trace shows of an episode, tick by tick."""

import dataclasses

import numpy as np
import pytest
from laboratory import CONTROL_DT

from sarah.episode.episode import simulate
from sarah.episode.push import Push
from sarah.episode.result import EpisodeResult
from sarah.episode.reward import highest_return, reward_rate
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import BalanceConfig
from sarah.robot.description import describe_robot


def test_return_is_equation_2_integrated_over_the_trace(paper_episode: EpisodeResult) -> None:
    trace = paper_episode.trace
    assert trace is not None
    # A row has the position before its tick, and the reward is that of the one after it. The robot starts at (0, 0).
    moved = [*trace.position[1:], paper_episode.final_position]
    rewards = [reward_rate(x, y, z, f) for (x, y, z), f in zip(moved, trace.steps_per_second, strict=True)]
    assert sum(rewards) * CONTROL_DT == pytest.approx(paper_episode.episode_return, rel=1e-12)
    ceiling = highest_return(describe_robot().standing_height, 29.0)
    assert paper_episode.score == pytest.approx(paper_episode.episode_return / ceiling)
    assert trace.score[0] == 0.0 and (np.diff(trace.score) >= 0.0).all()
    assert trace.score[-1] == pytest.approx(paper_episode.score, rel=0.001)


def test_trace_has_a_row_for_every_tick(paper_episode: EpisodeResult) -> None:
    trace = paper_episode.trace
    assert trace is not None
    assert len(trace) == 2900 and {len(values) for values in vars(trace).values()} == {2900}
    assert np.allclose(np.diff(trace.time), CONTROL_DT)
    assert set(trace.phase) == {"shift", "lift", "land"}
    assert trace.joints.shape == (2900, 6) and trace.ankles.shape == (2900, 4)
    assert not trace.push.any()


def test_trace_finds_the_tick_of_a_time(paper_episode: EpisodeResult) -> None:
    trace = paper_episode.trace
    assert trace is not None
    assert [trace.tick_at(time) for time in (0.0, 1.0, 1.013, 2.0, 99.0)] == [0, 0, 1, 100, 2899]
    assert all(trace.tick_at(time) == tick for tick, time in enumerate(trace.time))


def test_trace_shows_the_push() -> None:
    push = Push(newtons=(60.0, 60.0), degrees=(90.0, 90.0), at_seconds=(2.0, 2.0), duration=0.15)
    spec = EpisodeSpec((0.0,) * 4, 0, "balance", BalanceConfig(time_limit=3.0, push=push))
    trace = simulate(spec, record_trace=True).trace
    assert trace is not None
    assert trace.time[trace.push.any(axis=1)] == pytest.approx(np.arange(2.0, 2.145, CONTROL_DT))
    assert trace.push[trace.tick_at(2.1)] == pytest.approx([0.0, 60.0, 0.0])


def test_every_push_is_shown_while_it_acts_and_a_moment(paper_episode: EpisodeResult) -> None:
    trace = paper_episode.trace
    assert trace is not None
    forces = np.zeros((len(trace), 3))
    forces[100:110], forces[300:450], forces[450:455] = (5.0, 0.0, 0.0), (0.0, 7.0, 0.0), (0.0, -7.0, 0.0)
    pushed = dataclasses.replace(trace, push=forces)
    assert pushed.pushes() == [(100, 110), (300, 450), (450, 455)]
    shown = pushed.shown_pushes()
    assert [shown.count(force) for force in ((5.0, 0.0, 0.0), (0.0, 7.0, 0.0), (0.0, -7.0, 0.0))] == [60, 150, 60]
    assert len(shown) == len(trace) and shown[99] is None and shown[100] == shown[159] and shown[160] is None
