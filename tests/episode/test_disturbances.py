"""What an episode was subjected to is known without simulating it, and is what the episode has: a push above all."""

import dataclasses
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from laboratory import COARSE_PHYSICS

import sarah
from sarah import BalanceConfig, EpisodeConfig, EpisodeSpec, SarahError, simulate
from sarah.control.parameters import PAPER_STEPPING
from sarah.episode.push import NO_PUSH, SAGITTAL_DEGREES, Push, draw_push, push_words
from sarah.episode.robot_settings import conditions_of
from sarah.episode.task_answers import disturbances_of
from sarah.episode.trial import try_task
from sarah.robot.description import GROUPS
from sarah.robot.reading import GRAVITY, Side

UNEVEN = sarah.Terrain(slope_degrees=(2.0, 6.0), roughness=0.01, friction_left=(0.5, 0.6), friction_right=(0.2, 0.3))
SHORT = sarah.EpisodeConfig(time_limit=3.0, physics=COARSE_PHYSICS)


def spec(seed: int = 0, task: str | sarah.Task = "balance", **settings: Any) -> sarah.EpisodeSpec:
    found = sarah.load_task(task) if isinstance(task, str) else task
    return sarah.EpisodeSpec(found.baseline, seed, found, dataclasses.replace(found.episode, **settings))


@pytest.mark.parametrize("settings", [{"terrain": UNEVEN}, {"dimensions": {"torso_mass": 7.0, "hip_mass": 1.5}}])
def test_they_are_what_the_episode_draws(settings: dict[str, Any]) -> None:
    subject = spec(1, **settings)
    found, conditions = disturbances_of(subject), conditions_of(subject.config, 1)
    push = subject.task.draw_push(subject.config, 1)
    assert found is not None and push is not None
    newtons, sine, cosine, begin, friction, bandwidth, right, forward, *masses_and_offset = found
    assert (newtons * cosine, newtons * sine, begin) == pytest.approx((*push.force[:2], push.begin))
    assert math.hypot(sine, cosine) == pytest.approx(1.0)
    assert friction == pytest.approx(sum(conditions.friction_under(side) for side in Side) / 2)
    assert bandwidth == conditions.actuator_bandwidth
    degrees = math.hypot(right, forward)
    downhill, upright = -GRAVITY * math.sin(math.radians(degrees)), -GRAVITY * math.cos(math.radians(degrees))
    x, y = downhill * right / (degrees or 1.0), downhill * forward / (degrees or 1.0)
    assert conditions.ground.gravity == pytest.approx((x, y, upright))
    carried = {link: factor * subject.robot.masses[link] for link, factor in conditions.mass_factors.items()}
    masses = [sum(carried[link] for link in links) / 10.0 for links in GROUPS.values()]
    assert masses_and_offset == pytest.approx([*masses, *conditions.mass_offset])


@pytest.mark.parametrize("task", ["stepping", dataclasses.replace(sarah.BALANCE, draw_push=lambda config, seed: None)])
def test_no_push_is_zeros(task: str | sarah.Task) -> None:
    assert (disturbances_of(spec(0, task)) or ())[:4] == (0.0, 0.0, 0.0, 0.0)
    newtons, sine, cosine, begin, *_ = disturbances_of(spec(0, push=sarah.Push(newtons=0))) or ()
    assert (newtons, sine, cosine) == (0.0, 0.0, 0.0) and begin > 1.0


def task_of_file(folder: Path, disturbances: str) -> sarah.Task:
    text = "import dataclasses, sarah, numpy as np\nseen = []\nJUMP = dataclasses.replace(sarah.STEPPING, name='jump', "
    Path(folder, "my_task.py").write_text(f"{text}disturbances={disturbances})\n")
    return sarah.load_task(f"{folder / 'my_task.py'}:JUMP")


OWN = {"lambda spec: (spec.seed, True)": (5.0, 1.0), "lambda spec: np.array([spec.seed, 2])": (5.0, 2.0), "None": None}


@pytest.mark.parametrize(("disturbances", "expected"), OWN.items())
def test_a_task_of_a_file_names_its_own(tmp_path: Path, disturbances: str, expected: tuple[float, ...] | None) -> None:
    task = task_of_file(tmp_path, disturbances)
    given = disturbances_of(spec(5, task))
    assert given == expected and all(type(number) is float for number in given or ())
    try_task(task, SHORT)


@pytest.mark.parametrize(
    ("disturbances", "words"),
    [
        ("1 / 0", "my_task.py, line 3: ZeroDivisionError: division by zero"),
        ("{1.0}", "my_task.py:JUMP: disturbances must return a tuple of finite numbers, not {1.0}"),
        ("(1.0, float('nan'))", r"must return a tuple of finite numbers, not \(1.0, nan\)"),
        ("(len(seen), seen.append(1))[:1]", "my_task.py:JUMP: .*disturbances must depend on its argument only"),
        ("spec.parameters", "disturbances must not depend on the parameters, which are what is learned"),
        ("[0.0] * (1 + (spec.seed > 9))", "must return as many numbers for every episode, not 1 and 2"),
    ],
)
def test_a_trial_finds_mistakes_before_the_training(tmp_path: Path, disturbances: str, words: str) -> None:
    with pytest.raises(SarahError, match=f"{words}$") as caught:
        try_task(task_of_file(tmp_path, f"lambda spec: {disturbances}"), SHORT)
    assert "\n" not in str(caught.value)


def test_push_is_the_only_difference_between_forces() -> None:
    for share in (0.0, 1.0):
        soft, hard = (draw_push(Push((force, force), sagittal_share=share), seed=5) for force in (50.0, 100.0))
        assert hard.begin == soft.begin
        assert hard.force == pytest.approx(tuple(2 * component for component in soft.force))


def test_pushes_cover_every_direction_force_and_time() -> None:
    pushes = [draw_push(Push(), seed) for seed in range(400)]
    newtons, begins = [np.hypot(*push.force[:2]) for push in pushes], [push.begin for push in pushes]
    assert min(newtons) < 5.0 and 95.0 < max(newtons) <= 100.0
    assert 1.0 <= min(begins) < 1.1 and 3.9 < max(begins) <= 4.0
    quadrants = {(push.force[0] > 0, push.force[1] > 0) for push in pushes}
    assert len(quadrants) == 4 and all(push.force[2] == 0.0 for push in pushes)


def test_sagittal_pushes_point_within_30_degrees_of_the_y_axis() -> None:
    push = Push(newtons=(80.0, 80.0), degrees=(0.0, 0.0), sagittal_share=0.5)
    forces = [draw_push(push, seed).force for seed in range(1000)]
    degrees = np.array([math.degrees(math.atan2(y, x)) % 360.0 for x, y, _ in forces])  # against the clock
    groups = [degrees[abs(degrees - middle) <= SAGITTAL_DEGREES] - middle for middle in (90.0, 270.0)]
    assert sum(map(len, groups)) + (degrees == 0.0).sum() == 1000
    for group in groups:
        assert len(group) == pytest.approx(250, abs=50) and group.min() < -28.0 and group.max() > 28.0


def test_a_larger_sagittal_share_turns_some_pushes_only() -> None:
    """It changes neither force nor time; and a push that is sagittal at one share is the same at a larger one."""
    some, more = ([draw_push(Push(sagittal_share=share), seed) for seed in range(200)] for share in (0.3, 0.6))
    drawn = [draw_push(Push(), seed) for seed in range(200)]
    assert [push.begin for push in some] == [push.begin for push in drawn]
    assert [math.hypot(*push.force) for push in some] == pytest.approx([math.hypot(*push.force) for push in drawn])
    for plain, first, second in zip(drawn, some, more, strict=True):
        assert first in (plain, second)


def test_balance_without_v_and_push_steps_as_the_first_training() -> None:
    config = BalanceConfig(push=NO_PUSH, time_limit=2.5, stepping=PAPER_STEPPING)
    balance = simulate(EpisodeSpec((0.0,) * 4, 1, "balance", config))
    assert balance == simulate(EpisodeSpec(PAPER_STEPPING, 1, config=EpisodeConfig(time_limit=2.5)))


def test_a_push_in_words() -> None:
    assert push_words((100.0, 0.0, 0.0)) == ("push of 100 N", "to its right")
    assert push_words((0.0, 0.4, 0.0)) == ("push of 0.4 N", "forward")
    assert push_words((-50.0, -50.0, 0.0)) == ("push of 71 N", "left and backward")
    assert push_words((1.0, 0.0, 8.0)) == ("push of 8.1 N", "upward")
