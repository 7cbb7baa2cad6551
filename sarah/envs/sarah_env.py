"""The gymnasium environments of the two trainings: one episode of the robot is one step of the agent."""

from __future__ import annotations

import copy
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import gymnasium
import numpy as np

from sarah.episode.episode import Episode
from sarah.episode.from_mapping import from_mapping
from sarah.episode.settings import EpisodeConfig
from sarah.episode.spec import FIRST_TRAINING_SEED, EpisodeSpec
from sarah.episode.task_answers import disturbances_of
from sarah.episode.tasks import Task, task_named
from sarah.errors import ConfigurationError, SimulationError, shortened, unknown_name
from sarah.number import is_number, plain
from sarah.robot.reading import GRAVITY, SensorReading
from sarah.robot.scale import Scale

if TYPE_CHECKING:
    from sarah.simulation.renderer import Renderer

OBSERVATION_BOUND = 5.0
OBSERVED = (
    *((GRAVITY, "m/s^2"),) * 3,
    *((1.0, "rad/s"),) * 3,
    *((100.0, "N"),) * 4,
    *((1.0, "rad"),) * 4,
    *((0.1, "m"),) * 2,
)
"""Divisor of each of the 16 signals, which makes it of order 1, and its unit. It goes with the robot's size."""
ROUNDING = 2.0**-15
"""Distance beyond an end of [-1, 1] that roundings of 32-bit numbers explain: a wrapper that scales a narrow range far
from 0 adds some hundred units in the last place."""


class SarahEnv(gymnasium.Env[np.ndarray, np.ndarray]):
    """An environment in which an agent chooses the task's parameters once, and the episode's return is the reward.

    ``reset`` lets the robot stand for one second. ``step`` runs the pattern generator to the episode's end and always
    terminates. The observation is the 16 sensor signals after standing, each divided by its number in ``OBSERVED``,
    which goes with the robot's size, and clipped to [-5, 5]. The action is P1 to P5, or V1 to V4, with the box of the
    parameters scaled to [-1, 1]. ``info`` contains the episode's ``seed``, and after the step the ``parameters``, the
    ``result``, an :class:`~sarah.episode.result.EpisodeResult`, and the ``disturbances``, unless the task names none.

    :param task: task, or the name of one of this package: ``"stepping"`` to choose P1 to P5, ``"balance"`` to choose
        V1 to V4 and be pushed
    :param config: settings of the episodes; by default the task's own
    :param render_mode: ``"rgb_array"`` for pictures, or ``None``
    :param settings: settings to change, by name: ``engine="mujoco"``, ``time_limit=10``, ``push={"newtons": 80}``
    :raises ConfigurationError: naming the setting and its nearest valid name, if one is not allowed
    """

    metadata = {"render_modes": ["rgb_array"], "render_fps": 1}

    def __init__(
        self,
        task: str | Task[Any] = "stepping",
        config: EpisodeConfig | None = None,
        render_mode: str | None = None,
        **settings: Any,
    ) -> None:
        self.task = task_named(task)
        self.observation_space = gymnasium.spaces.Box(-OBSERVATION_BOUND, OBSERVATION_BOUND, (16,), np.float32)
        self.action_space = gymnasium.spaces.Box(-1.0, 1.0, (len(self.task.parameters),), np.float32)
        config = self.task.episode if config is None else self.task.checked_config(config, True)
        if isinstance(dimensions := settings.get("dimensions"), Mapping):
            config = config.for_robot({**config.dimensions, **dimensions}, self.task.episode)
        self.config = from_mapping(config, settings)
        self.render_mode = checked_render_mode(render_mode, self.metadata["render_modes"])
        self._episode: Episode | None = None
        self._is_over = True
        self._renderer: Renderer | None = None
        self._seed = 0
        self._parameters: tuple[float, ...] | None = None

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[np.ndarray, dict[str, Any]]:
        """Build a new world and stand for one second.

        :param seed: seed of the generator that draws the episodes' seeds; with the drawn one, ``info["seed"]``,
            :func:`sarah.simulate` repeats the episode
        :param options: options of gymnasium, which are ignored
        """
        super().reset(seed=seed)
        self._close_episode()
        self._seed, self._parameters = draw_seed(self.np_random), None
        self._episode = Episode(self.config, self._seed, self.task)
        self._is_over = False
        return observation_from(self._episode.stand(), self.config.scale), {"seed": self._seed}

    def step(self, action: np.ndarray) -> tuple[np.ndarray, float, bool, bool, dict[str, Any]]:
        """Run the pattern generator to the episode's end.

        :param action: values of the task's parameters, in order, scaled to [-1, 1]
        :raises ConfigurationError: if the action is not finite or out of its box, or if the episode is over
        """
        if self._episode is None or self._is_over:
            raise ConfigurationError("the episode is over: call reset before step")
        self._parameters = parameters = parameters_from(action, self.task)
        self._is_over = True
        result = self._episode.run(parameters)
        info = {"seed": self._seed, "parameters": parameters, "result": result}
        disturbances = disturbances_of(EpisodeSpec(parameters, self._seed, self.task, self.config))
        if disturbances is not None:
            info["disturbances"] = disturbances
        observation = observation_from(self._episode.robot.last_reading, self.config.scale)
        return observation, result.episode_return, True, False, info

    def render(self) -> np.ndarray | None:
        """Draw the robot as it stands now, on the ground of its episode.

        A push is drawn as an arrow while it acts, and for 0.6 s from its beginning: only an episode that ended in that
        time shows it. Nothing tells friction, masses, payload and delays, or a slope towards the camera.

        :return: uint8 array of shape (480, 640, 3), the picture of :mod:`sarah.pictures.video` without its text; the
            ground alone if the simulation has diverged; ``None`` without a render mode
        """
        if self.render_mode is None or self._episode is None:
            return None
        if self._renderer is None:
            from sarah.simulation.renderer import Renderer

            self._renderer = Renderer(self._episode.robot.description)
        return self._renderer.draw_simulator(self._episode.robot.simulation, force=self._episode.shown_push())

    def __getstate__(self) -> dict[str, Any]:
        """State of a copy, without the engine's worlds."""
        return {**vars(self), "_episode": None, "_renderer": None, "_has_episode": self._episode is not None}

    def __setstate__(self, state: dict[str, Any]) -> None:
        """Let a robot of the copy's own do what that of the other has done: its seed and parameters determine that.

        :param state: state of the other environment
        """
        has_episode = state.pop("_has_episode")
        vars(self).update(state)
        if has_episode:
            self._episode = Episode(self.config, self._seed, self.task)
            self._episode.stand()
            if self._parameters is not None:
                self._episode.run(self._parameters)

    def __copy__(self) -> SarahEnv:
        """Copy with a world and generator of its own."""
        return copy.deepcopy(self)

    def close(self) -> None:
        """Give the resources of the physics engine and the renderer back."""
        self._close_episode()
        if self._renderer is not None:
            self._renderer.close()
            self._renderer = None

    def _close_episode(self) -> None:
        if self._episode is not None:
            self._episode.close()
            self._episode = None


def draw_seed(generator: np.random.Generator) -> int:
    """Draw the seed of a training's next episode.

    :param generator: random generator of the environment
    """
    return int(generator.integers(FIRST_TRAINING_SEED, 2**32))


def observation_from(reading: SensorReading, scale: Scale) -> np.ndarray:
    """Scale 16 sensor signals to an observation.

    :param reading: sensor reading, in SI units
    :param scale: size of the robot
    :return: float32 array of shape (16,), of order 1
    """
    signals = (*reading.acceleration, *reading.angular_rate, *reading.pressures, *reading.joints)
    if not reading.is_finite:
        raise SimulationError(f"an observation must be finite, not {reading!r}")
    scaled = np.array(signals) / scale.all_scaled(OBSERVED)
    return np.clip(scaled, -OBSERVATION_BOUND, OBSERVATION_BOUND).astype(np.float32)


def checked_render_mode(render_mode: str | None, allowed: list[str]) -> str | None:
    """Check a render mode.

    :param render_mode: name of the mode; ``None`` draws nothing
    :param allowed: names that the environment knows
    :raises ConfigurationError: naming the mode and what is allowed
    """
    if render_mode is not None and render_mode not in allowed:
        raise ConfigurationError(unknown_name("render_mode", str(render_mode), [*allowed, "None"]))
    return render_mode


def checked_action(action: np.ndarray, count: int) -> np.ndarray:
    """Check an action. What lies beyond an end of [-1, 1] by rounding only comes to that end.

    :param action: numbers in [-1, 1]
    :param count: number of them
    :return: the numbers, as an array of floats
    :raises ConfigurationError: if the action is not finite or out of its box
    """
    values: Any = plain(action)
    values = list(map(plain, values)) if isinstance(values, (list, tuple)) else []
    if len(values) != count or not all(is_number(value) and abs(value) <= 1.0 + ROUNDING for value in values):
        raise ConfigurationError(f"an action must be {count} numbers within -1 and 1, not {shortened(plain(action))}")
    return np.clip(np.array(values, dtype=float), -1.0, 1.0)


def parameters_from(action: np.ndarray, task: Task) -> tuple[float, ...]:
    """Turn an action into a task's parameters.

    :param action: one number in [-1, 1] for each parameter
    :param task: task that owns the parameters
    :raises ConfigurationError: if the action is not finite or out of its box
    """
    return task.box.unscaled(checked_action(action, len(task.parameters)).tolist())
