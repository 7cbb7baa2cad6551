"""What NAF says of rewards and of values that it cannot learn from, and of threads that wait for each other."""

import re
import time
import warnings

import numpy as np
import pytest
import torch as th

from sarah.agents import NAF
from sarah.agents.naf_warnings import Watch, reward_warning, value_warning


@pytest.mark.parametrize(
    ("mean", "std", "said"),
    [
        (-6.0, 0.5, "far below 0, .* as reward [+] 6;"),
        (6.0, 0.5, "far above 0, .* as reward - 6;"),
        (-4.0, 0.5, None),
        (-12.0, 2.0, "far below 0"),
        (-8.0, 2.0, None),
        (0.0, 31.0, "deviation of 31 are large"),
        (0.0, 29.0, None),
    ],
)
def test_rewards_are_far_by_their_deviation_large_by_its_size(mean, std, said):
    rewards = mean + std * np.array([-1.0, 1.0, -1.0, 1.0, -1.0, 1.0], np.float32)
    text = reward_warning(rewards)
    with np.errstate(all="raise"):  # nothing is said of what is no number, and of a few
        assert reward_warning(np.append(rewards, np.float32(np.inf))) is None
    assert reward_warning(rewards[:4]) is None and (reward_warning(rewards[:5]) is None) == (text is None)
    assert text is None if said is None else re.search(said, text or "")


@pytest.mark.parametrize(
    ("count", "warm_up", "is_full", "are_judged"),
    [
        (19, 20, False, False),
        (20, 20, False, True),
        (99, 0, False, False),  # without a warm-up
        (100, 0, False, True),
        (4, 2, False, False),
        (5, 2, False, True),
        (6, 20, True, True),  # there will never be more
    ],
)
def test_rewards_are_judged_once_when_they_are_enough(count, warm_up, is_full, are_judged):
    watch, rewards = Watch(), np.full(count, -100.0)
    said = [watch.judge_rewards(rewards, warm_up, is_full) is not None for _ in range(2)]
    assert said == [are_judged, False] and watch.judged_rewards == are_judged


def test_the_remedy_of_values_that_run_away_is_one_that_is_left():
    remedies = {(100.0, True): "wider exploration_std or a lower", (100.0, False): "for W", (0.5, True): "rewards up"}
    for (bound, has_w), remedy in remedies.items():
        text = value_warning(largest=2.5 * bound, ceiling=bound, bound=bound, gamma=0.99, has_w=has_w)
        assert remedy in text and "by 1.5 times" in text


def test_v_is_judged_by_rewards_and_said_to_run_away_once():
    """Where all rewards are negative no value is above 0, as an episode may end."""
    fresh, watch = Watch(), Watch(updates=1001)
    assert Watch().judge_value(9.0, (0.0, 0.0), 0.99, True) == (None, None)
    assert fresh.judge_value(50.0, (-100.0, -10.0), 0.99, True) == (1.5, None)
    assert fresh.judge_value(1000.0, (0.0, 0.0), 0.99, True) == (11.0, None)  # networks are still fresh
    assert watch.judge_value(150.0, (-40.0, 100.0), 0.99, True) == (1.5, None)
    ratio, said = watch.judge_value(1060.0, (0.0, 50.0), 0.99, False)
    assert ratio == 10.6 and re.search(
        r"^V of 1\.06e\+03 is beyond .*: it runs away\. Remedy: .* layers for W", said or ""
    )
    assert watch.judge_value(1060.0, (0.0, 50.0), 0.99, False) == (10.6, None)


class SlowSGD(th.optim.SGD):
    """As slow as threads that wait."""

    def step(self, closure=None):
        time.sleep(0.06)
        return super().step(closure)


def thread_warnings(model: NAF) -> list[str]:
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        model.learn(25)
    return [str(one.message) for one in caught if "threads" in str(one.message)]


def test_updates_that_threads_make_slow_are_said_once(monkeypatch, tmp_path):
    monkeypatch.setattr(th, "get_num_threads", lambda: 4)
    policy_kwargs = {"net_arch": [8], "optimizer_class": SlowSGD}
    model = NAF("MlpPolicy", "Pendulum-v1", policy_kwargs=policy_kwargs, learning_starts=10, batch_size=8)
    (said,) = thread_warnings(model)
    assert re.match(r"updates take 0\.\d+ s each, as the 4 threads .* Remedy: torch\.set_num_threads\(1\), or", said)
    model.save(tmp_path / "slow")
    assert len(thread_warnings(NAF.load(tmp_path / "slow", env=model.env, learning_starts=10))) == 1


SMALL_WEIGHTS = (100, 100)


@pytest.mark.parametrize(
    ("threads", "seconds", "shape", "is_said"),
    [
        (2, 1.0, SMALL_WEIGHTS, True),
        (1, 1.0, SMALL_WEIGHTS, False),  # nothing to wait for
        (2, 0.4, SMALL_WEIGHTS, False),  # quick
        (2, 1.0, (1000, 1000), False),  # much to do for each thread
        (2, 1.0, (10, 10, 3, 3), False),  # of images: each weight is used many times
    ],
)
def test_threads_are_blamed_once_where_they_wait(monkeypatch, threads, seconds, shape, is_said):
    monkeypatch.setattr(th, "get_num_threads", lambda: threads)
    weights, watch = [th.zeros(shape)], Watch()
    assert (Watch().judge_time(seconds, 10, weights, batch_size=256) is not None) == is_said
    said = [watch.judge_time(0.3 * seconds, 1, weights, batch_size=256) is not None for _ in range(4)]
    assert said == [False, is_said, False, False]  # very slow ones before ten are made
