"""The gymnasium environments: what checkers, libraries and users expect of it."""

import math
from dataclasses import replace
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from laboratory import COARSE_PHYSICS, NEEDS_PYBULLET, WAYS, need
from PIL import ImageColor
from stable_baselines3.common.env_checker import check_env as sb3_check_env

import sarah
from sarah import BALANCE, STEPPING, BalanceConfig, EpisodeConfig, Push, Randomisation, SensorReading, Task
from sarah.control.parameters import PAPER_STEPPING, Parameter
from sarah.envs.registration import ENVIRONMENTS, OPERATION
from sarah.envs.sarah_env import SarahEnv, observation_from, parameters_from
from sarah.episode.spec import FIRST_TRAINING_SEED, EpisodeSpec
from sarah.episode.task_answers import disturbances_of
from sarah.errors import ConfigurationError, SimulationError
from sarah.robot.scale import Scale
from sarah.scenery.camera import STANDARD_CAMERA
from sarah.scenery.floor import floor
from sarah.scenery.push_arrow import PUSH
from sarah.simulation.engines import is_installed
from sarah.simulation.mujoco_simulator import MujocoSimulator
from sarah.simulation.simulator import TorsoState
from sarah.simulation.terrain import Terrain, draw_ground

SHORT = EpisodeConfig(time_limit=1.5, physics=COARSE_PHYSICS)
SHORT_BALANCE = BalanceConfig(time_limit=2.4, physics=COARSE_PHYSICS)
PAPER_ACTION = np.array(PAPER_STEPPING, dtype=np.float32) - 1.0


def test_environments_do_not_share_their_spaces() -> None:
    first, second, again = (SarahEnv(config=SHORT).action_space for _ in range(3))
    first.seed(0), second.seed(0)
    first.sample()
    again.seed(0)
    assert (second.sample() == again.sample()).all()


def test_a_task_of_your_own_is_an_environment() -> None:
    task = replace(STEPPING, name="mine", episode=SHORT, reward=lambda tick, config: tick.height)
    env = gymnasium.make("SarahEpisode-v0", task=task)
    sb3_check_env(env.unwrapped)
    env.reset(seed=0)
    _, reward, *_ = env.step(PAPER_ACTION)
    assert 0.35 < float(reward) < 0.45  # half a second of some 0.8 m


def test_settings_are_keywords() -> None:
    need("mujoco")
    env = gymnasium.make("SarahBalance-v0", engine="mujoco", time_limit=10, push={"newtons": 80, "degrees": [0, 90]})
    config = env.unwrapped.config  # type: ignore[attr-defined]
    assert config == BalanceConfig(engine="mujoco", time_limit=10.0, push=Push((80.0, 80.0), (0.0, 90.0)))
    again = gymnasium.make("SarahBalance-v0", config=config, randomisation=Randomisation(enabled=False))
    expected = replace(config, randomisation=Randomisation(enabled=False))
    assert again.unwrapped.config == expected  # type: ignore[attr-defined]


def test_mistakes_in_keywords_are_one_line() -> None:
    mistakes: list[tuple[dict[str, Any], str]] = [
        ({"engin": "mujoco"}, "unknown key 'engin', did you mean 'engine'?"),
        ({"push": {"newton": 1}}, "unknown key 'push.newton', did you mean 'push.newtons'?"),
        ({"task": "balanse"}, "unknown task 'balanse', did you mean 'balance'"),
        ({"render_mode": "rgb"}, r"^unknown render_mode 'rgb', did you mean 'rgb_array'\?"),
    ]
    for keywords, words in mistakes:
        with pytest.raises(ConfigurationError, match=words) as caught:
            SarahEnv(**{"task": "balance", **keywords})
        assert "\n" not in str(caught.value)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize(
    ("name", "task", "config"), [("SarahStepping-v0", STEPPING, SHORT), ("SarahBalance-v0", BALANCE, SHORT_BALANCE)]
)
def test_checkers_pass_without_a_warning(name: str, task: Task, config: EpisodeConfig) -> None:
    usual = gymnasium.make(name)
    assert isinstance(usual.unwrapped, SarahEnv) and usual.unwrapped.config == task.episode
    env = gymnasium.make(name, config=config, render_mode="rgb_array")
    check_env(env.unwrapped, skip_render_check=not is_installed("pybullet"))
    sb3_check_env(env.unwrapped)
    assert env.unwrapped.task is task and env.action_space.shape == (len(task.parameter_names),)  # type: ignore[attr-defined]


@pytest.mark.parametrize(
    ("task", "config", "action"),
    [("stepping", SHORT, PAPER_ACTION), ("balance", SHORT_BALANCE, np.array([0.5, 0.0, 0.5, -0.1], np.float32))],
)
def test_reset_stands_and_step_simulates_to_the_end(task: str, config: EpisodeConfig, action: np.ndarray) -> None:
    env = SarahEnv(task, config)
    with pytest.raises(ConfigurationError, match="call reset"):
        env.step(action)
    observation, info = env.reset(seed=1)
    assert observation.shape == (16,) and info["seed"] >= FIRST_TRAINING_SEED
    _, reward, terminated, truncated, info = env.step(action)
    assert terminated and not truncated
    assert info["parameters"] == pytest.approx(PAPER_STEPPING if task == "stepping" else (1.0, 0.0, 1.0, -0.2))
    assert info["result"] == sarah.simulate(EpisodeSpec(info["parameters"], info["seed"], task, config))
    assert reward == info["result"].episode_return
    with pytest.raises(ConfigurationError, match="call reset"):  # an episode has one step
        env.step(action)


def test_observation_is_of_order_one_and_upright() -> None:
    env = SarahEnv(engine="mujoco")
    observation, _ = env.reset(seed=1)
    assert env.observation_space.contains(observation)
    inertial, pressures, joints = np.split(observation, [6, 10])
    assert inertial == pytest.approx(np.array([0, 0, 1, 0, 0, 0]), abs=0.1) and joints == pytest.approx(0.0, abs=0.1)
    assert (pressures > 0.1).all() and (pressures < 1.5).all()
    reading = SensorReading((0.0, 0.0, 9.81), (0.0,) * 3, (75.0,) * 4, (math.nan,) * 6)
    with pytest.raises(SimulationError, match=r"an observation must be finite, not .*nan"):
        observation_from(reading, Scale())


def test_a_seed_gives_a_series_of_different_episodes() -> None:
    env, other = SarahEnv(config=SHORT), SarahEnv(config=SHORT)
    series, again = ([one.reset(seed=5), one.reset()] for one in (env, other))
    assert [observation.tolist() for observation, _ in series] == [observation.tolist() for observation, _ in again]
    seeds = [info["seed"] for _, info in (*series, *again)]
    assert seeds[:2] == seeds[2:] and seeds[0] != seeds[1]


def test_step_tells_the_disturbances_that_the_task_names() -> None:
    for task in (BALANCE, replace(BALANCE, name="mine", disturbances=None)):
        env = SarahEnv(task, BalanceConfig(time_limit=1.2, physics=COARSE_PHYSICS, push=Push(newtons=(50, 80))))
        env.reset(seed=0)
        info = env.step(np.zeros(4, np.float32))[-1]
        spec = EpisodeSpec(info["parameters"], info["seed"], task, env.config)
        assert info.get("disturbances") == disturbances_of(spec)


def test_actions_that_rounding_puts_outside_are_the_ends() -> None:
    beyond = np.nextafter(np.ones(5, np.float32), np.float32(2.0))
    assert parameters_from(beyond, STEPPING) == (2.0,) * 5 and parameters_from(-beyond, STEPPING) == (0.0,) * 5
    seen = gymnasium.Env[np.ndarray, np.ndarray]()
    seen.action_space = seen.observation_space = gymnasium.spaces.Box(-1.0, 1.0, (5,), np.float32)
    for low in np.random.default_rng(0).uniform(-10.0, 10.0, 100).astype(np.float32):  # as wrappers scale
        scaled = gymnasium.wrappers.RescaleAction(seen, low, low + np.float32(0.1))
        assert isinstance(scaled.action_space, gymnasium.spaces.Box)
        assert parameters_from(scaled.action(scaled.action_space.high), STEPPING) == pytest.approx((2.0,) * 5, abs=1e-3)


def test_impossible_actions_are_refused() -> None:
    env = SarahEnv(config=SHORT)
    env.reset(seed=0)
    for action in (np.full(5, np.nan), np.full(5, -1.0001), np.zeros(4), np.zeros((1, 5)), ["0"] * 5, None):
        with pytest.raises(ConfigurationError, match="an action must be 5 numbers within -1 and 1"):
            env.step(action)  # type: ignore[arg-type]


@pytest.mark.parametrize(("low", "high"), [(-0.1, 0.2), (-1.0, -0.45), (0.0, 2.0)])
def test_the_ends_of_an_action_are_the_ends_of_the_range(low: float, high: float) -> None:
    """Rounded, -0.1 + 0.3 is more than 0.2, which the task would refuse."""
    task = replace(STEPPING, parameters=(Parameter("odd", low, high, "", "a range", ""),), baseline=(low,))
    assert parameters_from(np.array([-1.0]), task) == (low,)
    assert parameters_from(np.array([1.0]), task)[0] <= high
    assert task.box.checked(parameters_from(np.array([1.0]), task))[0] == pytest.approx(high)
    for end in (low, high):  # a 32-bit number is the end that it stands for
        for value in (np.float32(end), float(np.float32(end))):
            assert low <= task.box.checked((value,))[0] <= high
    with pytest.raises(ConfigurationError, match="parameter odd must be between"):
        task.box.checked((high + 1e-5,))


def test_a_robot_that_diverges_while_it_stands_ends_its_episode(monkeypatch: pytest.MonkeyPatch) -> None:
    """A learner goes on: the step is bad, and not forbidden."""
    read = MujocoSimulator.read

    def broken(simulator: MujocoSimulator) -> SensorReading:
        reading = read(simulator)
        return reading._replace(acceleration=(math.nan, 0.0, 0.0)) if simulator.time > 0.5 else reading

    monkeypatch.setattr(MujocoSimulator, "read", broken)
    env = SarahEnv(config=SHORT, engine="mujoco")
    observation, _ = env.reset(seed=0)
    _, reward, terminated, _, info = env.step(PAPER_ACTION)
    assert np.isfinite(observation).all() and terminated and reward == 0.0 and info["result"].termination == "diverged"


@NEEDS_PYBULLET
@pytest.mark.parametrize("terrain", [Terrain(slope_degrees=9.0), Terrain(roughness=0.02)], ids=["slope", "bumps"])
def test_render_shows_the_ground_of_the_episode(terrain: Terrain) -> None:
    env = SarahEnv(config=SHORT, terrain=terrain, render_mode="rgb_array")
    _, info = env.reset(seed=3)
    picture = env.render()
    assert picture is not None and picture.shape == (480, 640, 3) and picture.std() > 10
    camera = STANDARD_CAMERA._replace(ground=draw_ground(terrain, info["seed"]))
    beside = (slice(380, 480), slice(0, 150))  # no robot and no shadow
    assert (picture[beside] == floor(640, 480, camera)[beside]).all()


@NEEDS_PYBULLET
@pytest.mark.parametrize(("end", "is_shown"), [(2.2, True), (3.0, False)])
def test_render_shows_the_push_while_a_film_does(end: float, is_shown: bool) -> None:
    config = BalanceConfig(time_limit=end, physics=COARSE_PHYSICS, push=Push(60.0, 0.0, 2.0))
    env = SarahEnv("balance", config, render_mode="rgb_array")
    env.reset(seed=0)
    before = env.render()
    env.step(np.zeros(4, np.float32))
    after = env.render()
    purple = [np.equal(np.array(picture), ImageColor.getrgb(PUSH)).all(axis=2).any() for picture in (before, after)]
    assert purple == [False, is_shown]


@NEEDS_PYBULLET
def test_render_shows_the_floor_alone_if_the_state_is_nan(monkeypatch: pytest.MonkeyPatch) -> None:
    env = SarahEnv(config=SHORT, engine="mujoco", render_mode="rgb_array")
    env.reset(seed=0)
    state = TorsoState((math.nan,) * 3, (math.nan,) * 4, (0.0,) * 3, (0.0,) * 3)
    monkeypatch.setattr(MujocoSimulator, "torso_state", lambda _: state)
    with np.errstate(all="raise"):
        picture = env.render()
    assert picture is not None and (picture == floor(640, 480, STANDARD_CAMERA)).all()


def made(name: str, engine: str) -> Any:
    need(engine)
    given: dict[str, Any] = {"engine": engine, "physics": {"rate": 100, "solver_iterations": 5}}
    if name == OPERATION:
        return gymnasium.make(name, robot=given, settle_seconds=0.5, measure_seconds=0.5).unwrapped
    task: dict[str, Any] = {} if "task" in ENVIRONMENTS[name] else {"task": "balance"}
    return gymnasium.make(name, time_limit=1.5, **given, **task).unwrapped


@pytest.mark.parametrize(
    ("name", "engine", "way"),
    [
        *(("SarahStepping-v0", "pybullet", way) for way in WAYS),
        ("SarahBalance-v0", "mujoco", "deepcopy"),
        ("SarahEpisode-v0", "pybullet", "deepcopy"),
        *((OPERATION, engine, way) for engine in ("pybullet", "mujoco") for way in ("copy", "pickle")),
    ],
)
def test_a_copied_environment_does_what_the_other_does(name: str, engine: str, way: str) -> None:
    env = made(name, engine)
    env.reset(seed=1)
    standing = WAYS[way](env)
    action = np.full(env.action_space.shape, 0.3, np.float32)
    reward = env.step(action)[1]
    stepped = WAYS[way](env)
    assert standing.step(action)[1] == reward
    following = [one.reset()[0].tobytes() for one in (env, standing, stepped)]
    assert len(set(following)) == 1
