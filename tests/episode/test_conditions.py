"""Grounds, robots and pushes of an episode: what they change, what they leave alone, what is known of them before."""

import math
from contextlib import closing
from dataclasses import replace
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest
from laboratory import COARSE_PHYSICS, NoPhysics, turned

import sarah
from sarah import BalanceConfig, EpisodeConfig, EpisodeResult, EpisodeSpec, Physics, simulate
from sarah.control.parameters import PAPER_STEPPING
from sarah.envs.sarah_env import observation_from
from sarah.episode.episode import Episode
from sarah.episode.parameter_sets import PARAMETER_SETS
from sarah.episode.push import NO_PUSH, SAGITTAL_DEGREES, Push, draw_push, push_words
from sarah.episode.robot_settings import conditions_of
from sarah.episode.running_robot import RunningRobot
from sarah.episode.task_answers import disturbances_of
from sarah.episode.tasks.balance import TRAINED_STEPPING
from sarah.episode.trial import try_task
from sarah.episode.workers import begin_episode
from sarah.robot.description import GROUPS, RobotDescription
from sarah.robot.dimensions import dimensions_alike
from sarah.robot.reading import GRAVITY, Side
from sarah.scenery.ground import LEVEL
from sarah.simulation.engines import Engine
from sarah.simulation.randomisation import Conditions, Randomisation
from sarah.simulation.simulator import TorsoState
from sarah.simulation.terrain import Terrain, draw_ground

UPHILL_IN_FRONT = Terrain((20.0, 20.0), (90.0, 90.0))


class Leaning(NoPhysics):
    """A simulator whose robot leans backward all the time; it keeps the conditions that it was built with."""

    degrees = 0.0

    def __init__(self, robot: RobotDescription, physics: Physics, conditions: Conditions) -> None:
        super().__init__()
        self.conditions = conditions

    def torso_state(self) -> TorsoState:
        return super().torso_state()._replace(orientation=turned(0.0, math.radians(self.degrees)))


def drawn_for(config: EpisodeConfig, seed: int = 3) -> Conditions:
    return cast(Leaning, Episode(config, seed, build=Leaning).robot.simulation).conditions


def test_slope_changes_nothing_else_that_the_seed_draws() -> None:
    level, slope = drawn_for(EpisodeConfig()), drawn_for(EpisodeConfig(terrain=UPHILL_IN_FRONT))
    assert level.ground == LEVEL and slope.ground == draw_ground(UPHILL_IN_FRONT, 3) != LEVEL
    assert replace(slope, ground=LEVEL) == level
    config = EpisodeConfig(terrain=Terrain((0.0, 10.0)), randomisation=Randomisation(enabled=False))
    assert drawn_for(config, 1).ground != drawn_for(config, 2).ground


@pytest.mark.parametrize("strength", [1.0, 0.165])
def test_tilt_of_a_tick_is_from_gravitys_vertical(strength: float) -> None:
    tilts = []

    def reward(tick: sarah.Tick, config: EpisodeConfig) -> float:
        tilts.append(math.degrees(tick.tilt))
        return 1.0

    config = EpisodeConfig(terrain=UPHILL_IN_FRONT)
    conditions = drawn_for(config, 0)
    x, y, z = (strength * component for component in conditions.ground.gravity)
    other = replace(conditions, ground=replace(conditions.ground, gravity=(x, y, z)))
    task = replace(sarah.STEPPING, name="watched", reward=reward, best_reward=1.0)
    episode = Episode(config, 0, task, build=Leaning, conditions=other)
    episode.stand()
    episode.start(TRAINED_STEPPING)
    episode.tick()
    assert tilts == pytest.approx([20.0])


def step_on(engine: Engine, terrain: Terrain, seed: int = 3, seconds: float = 5.0) -> EpisodeResult:
    config = EpisodeConfig(engine=engine, time_limit=seconds, terrain=terrain)
    return simulate(EpisodeSpec(TRAINED_STEPPING, seed, config=config))


def test_robot_steps_on_a_gentle_slope_and_slides_on_a_steep_one(engine: Engine) -> None:
    gentle, steep = (step_on(engine, terrain, 0) for terrain in (Terrain((3.0, 3.0), (90.0, 90.0)), UPHILL_IN_FRONT))
    assert gentle.survived and gentle.score > 0.7
    assert steep.termination == "left_box" and steep.final_position[1] < -0.25


def test_robot_steps_on_bumps_and_slower_than_on_the_plane(engine: Engine) -> None:
    plane, bumps = (step_on(engine, Terrain(roughness=(height, height))) for height in (0.0, 0.01))
    assert bumps.survived and 1.5 < bumps.steps_per_second < plane.steps_per_second
    assert bumps.shifts_by_sensors > 0.8 and 0.02 < bumps.sole_clearance < 0.04


def test_an_episode_on_bumps_repeats_whatever_was_before(engine: Engine) -> None:
    terrain = Terrain(roughness=(0.0, 0.02), cell=(0.03, 0.06), friction_left=(0.2, 0.4))
    first = step_on(engine, terrain, seconds=1.5)
    step_on(engine, terrain, seed=4, seconds=1.5)
    assert step_on(engine, terrain, seconds=1.5) == first


PARAMETERS = PARAMETER_SETS["stepping"].spec.parameters


def stepping(engine: Engine, length: float, mass: float) -> EpisodeResult:
    """A robot of some size without errors of the sensors, for as many steps as any other."""
    time, dimensions = math.sqrt(length), dimensions_alike(length, mass)
    config = EpisodeConfig(engine=engine, dimensions=dimensions, step_frequency=3.0 / time, time_limit=1.0 + 8.0 * time)
    config = replace(config, randomisation=replace(config.randomisation, enabled=False))
    return simulate(EpisodeSpec(PARAMETERS, 0, config=config))


def test_a_robot_alike_steps_alike(engine: Engine) -> None:
    """The control rate stays, which is all that is not alike."""
    default, other = stepping(engine, 1.0, 1.0), stepping(engine, 0.3125, 4 / 30)
    assert other.survived and other.score == pytest.approx(default.score, abs=0.05)
    assert other.steps_per_second * math.sqrt(0.3125) == pytest.approx(default.steps_per_second, rel=0.12)
    assert other.sole_clearance / 0.3125 == pytest.approx(default.sole_clearance, rel=0.25)
    assert other.shifts_by_sensors > 0.9 and other.lifts_by_sensors > 0.9


def test_what_an_agent_sees_of_a_robot_alike_is_alike() -> None:
    seen = []
    for length, mass in ((1.0, 1.0), (0.3125, 4 / 30), (4.0, 20.0)):
        config = EpisodeConfig(dimensions=dimensions_alike(length, mass), randomisation=Randomisation(enabled=False))
        seen.append(observation_from(begin_episode(EpisodeSpec(PARAMETERS, 0, config=config)), config.scale))
    assert all(other == pytest.approx(seen[0], abs=0.1) for other in seen[1:])


def test_the_feet_carry_a_payload(engine: Engine) -> None:
    def load(payload: float) -> float:
        perfect, dimensions = Randomisation(enabled=False), {"torso_mass": 6.0, "hip_mass": 2.0}
        config = EpisodeConfig(engine=engine, randomisation=perfect, payload=payload, dimensions=dimensions)
        with closing(RunningRobot(config, 0)) as robot:
            return sum(robot.stand().pressures)

    assert load(6.0) - load(0.0) == pytest.approx(6.0 * GRAVITY, rel=0.05)


def test_a_payload_adds_to_what_the_seed_draws() -> None:
    without, carrying = (drawn_for(EpisodeConfig(payload=mass)).mass_factors for mass in (0.0, 4.0))
    assert {**carrying, "torso": carrying["torso"] - 4.0 / 8.0} == pytest.approx(without)


UNEVEN = sarah.Terrain(slope_degrees=(2.0, 6.0), roughness=0.01, friction_left=(0.5, 0.6), friction_right=(0.2, 0.3))
SHORT = sarah.EpisodeConfig(time_limit=3.0, physics=COARSE_PHYSICS)


def spec(seed: int = 0, task: str | sarah.Task = "balance", **settings: Any) -> sarah.EpisodeSpec:
    found = sarah.load_task(task) if isinstance(task, str) else task
    return sarah.EpisodeSpec(found.baseline, seed, found, replace(found.episode, **settings))


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


@pytest.mark.parametrize("task", ["stepping", replace(sarah.BALANCE, draw_push=lambda config, seed: None)])
def test_no_push_is_zeros(task: str | sarah.Task) -> None:
    assert (disturbances_of(spec(0, task)) or ())[:4] == (0.0, 0.0, 0.0, 0.0)
    newtons, sine, cosine, begin, *_ = disturbances_of(spec(0, push=sarah.Push(newtons=0))) or ()
    assert (newtons, sine, cosine) == (0.0, 0.0, 0.0) and begin > 1.0


def task_of_file(folder: Path, disturbances: str) -> sarah.Task:
    text = "import dataclasses, sarah, numpy as np\nJUMP = dataclasses.replace(sarah.STEPPING, name='jump', "
    Path(folder, "my_task.py").write_text(f"{text}disturbances={disturbances})\n")
    return sarah.load_task(f"{folder / 'my_task.py'}:JUMP")


OWN = {"lambda spec: (spec.seed, True)": (5.0, 1.0), "lambda spec: np.array([spec.seed, 2])": (5.0, 2.0), "None": None}


@pytest.mark.parametrize(("disturbances", "expected"), OWN.items())
def test_a_task_of_a_file_names_its_own(tmp_path: Path, disturbances: str, expected: tuple[float, ...] | None) -> None:
    task = task_of_file(tmp_path, disturbances)
    given = disturbances_of(spec(5, task))
    assert given == expected and all(type(number) is float for number in given or ())
    try_task(task, SHORT)


def test_hard_push_throws_the_robot_over_and_a_soft_one_does_not() -> None:
    def pushed(newtons: float) -> EpisodeResult:
        push = Push(newtons=(newtons, newtons), degrees=(90.0, 90.0), at_seconds=(2.0, 2.0))
        config = BalanceConfig(push=push, time_limit=4.0, randomisation=Randomisation(enabled=False))
        return simulate(EpisodeSpec((1.0, 0.0, 1.0, 0.0), 0, "balance", config))

    assert pushed(40.0).survived
    thrown = pushed(300.0)
    assert thrown.termination == "left_box" and thrown.final_position[1] > 0.2
    assert 2.15 < thrown.duration < 3.0


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
