"""What an episode was subjected to is known without simulating it, and is what the episode has."""

import dataclasses
import math
from pathlib import Path
from typing import Any

import pytest
from laboratory import COARSE_PHYSICS

import sarah
from sarah.episode.robot_settings import conditions_of
from sarah.episode.task_answers import disturbances_of
from sarah.episode.trial import try_task
from sarah.errors import SarahError, TaskError
from sarah.robot.description import GROUPS
from sarah.robot.reading import GRAVITY, Side

UNEVEN = sarah.Terrain(slope_degrees=(2.0, 6.0), roughness=0.01, friction_left=(0.5, 0.6), friction_right=(0.2, 0.3))
SHORT = sarah.EpisodeConfig(time_limit=3.0, physics=COARSE_PHYSICS)


def spec(seed: int = 0, task: str | sarah.Task = "balance", **settings: Any) -> sarah.EpisodeSpec:
    found = sarah.load_task(task) if isinstance(task, str) else task
    return sarah.EpisodeSpec(found.baseline, seed, found, dataclasses.replace(found.episode, **settings))


@pytest.mark.parametrize("settings", [{"terrain": UNEVEN}, {"dimensions": {"torso_mass": 7.0, "hip_mass": 1.5}}])
def test_they_are_what_the_episode_draws(settings: dict[str, Any]) -> None:
    seed = 1
    subject = spec(seed, **settings)
    newtons, sine, cosine, begin, friction, bandwidth, right, forward, *masses_and_offset = disturbances_of(subject)
    push = subject.task.draw_push(subject.config, seed)
    assert (newtons * cosine, newtons * sine, begin) == pytest.approx((*push.force[:2], push.begin))
    assert math.hypot(sine, cosine) == pytest.approx(1.0)
    conditions = conditions_of(subject.config, seed)
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


OWN = {
    "lambda spec: (spec.seed, True)": (5.0, 1.0),
    "lambda spec: np.array([spec.seed, 0.5])": (5.0, 0.5),
    "None": None,
}


@pytest.mark.parametrize(("disturbances", "expected"), OWN.items())
def test_a_task_of_a_file_names_its_own(tmp_path: Path, disturbances: str, expected: tuple[float, ...] | None) -> None:
    task = task_of_file(tmp_path, disturbances)
    given = disturbances_of(spec(5, task))
    assert given == expected and all(type(number) is float for number in given or ())
    try_task(task, SHORT)


@pytest.mark.parametrize(
    ("disturbances", "words"),
    [
        ("lambda spec: 1 / 0", "my_task.py, line 3: ZeroDivisionError: division by zero"),
        ("lambda spec: {1.0}", "my_task.py:JUMP: disturbances must return a tuple of finite numbers, not {1.0}"),
        ("lambda spec: (1.0, float('nan'))", r"must return a tuple of finite numbers, not \(1.0, nan\)"),
    ],
)
def test_mistakes_are_one_line(tmp_path: Path, disturbances: str, words: str) -> None:
    with pytest.raises(SarahError, match=words) as caught:
        disturbances_of(spec(0, task_of_file(tmp_path, disturbances)))
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("disturbances", "words"),
    [
        ("lambda spec: (len(seen), seen.append(1))[:1]", "disturbances must depend on its argument only"),
        ("lambda spec: spec.parameters", "disturbances must not depend on the parameters, which are what is learned"),
        ("lambda spec: [0.0] * (1 + (spec.seed > 9))", "must return as many numbers for every episode, not 1 and 2"),
    ],
)
def test_a_trial_finds_mistakes_before_the_training(tmp_path: Path, disturbances: str, words: str) -> None:
    with pytest.raises(TaskError, match=f"^my_task.py:JUMP: .*{words}$"):
        try_task(task_of_file(tmp_path, disturbances), SHORT)
