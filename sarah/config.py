"""What an experiment's settings are: plain dataclasses, read from files, written beside every run.

Light on purpose: commands import it before anything slow.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any, Literal, TypeVar, get_args, get_origin, get_type_hints

from sarah.errors import ConfigurationError, unknown_name
from sarah.files import replace_text
from sarah.tasks import BALANCE, STEPPING, TASKS

STAND_SECONDS = 1.0
"""How long the robot stands before the pattern generator starts; the paper's."""
SLOWEST_CONTROL_RATE, FASTEST_CONTROL_RATE = 50, 1000
TRAINED_STEPPING = (0.41, 0.52, 0.62, 1.17, 1.37)
"""P1 to P5 that the balance task keeps unless others are given: what NAF learned from seed 1, to two digits."""

AGENTS = ("naf", "td3", "sac", "ddpg")
"""Learn by reinforcement, with networks."""
SEARCHERS = ("cma-es", "gp", "tpe", "random")
"""Black-box optimisers."""
ALGORITHMS = AGENTS + SEARCHERS
RewardForm = Literal["symmetric", "printed"]
ConfigType = TypeVar("ConfigType")


@dataclass(frozen=True)
class Physics:
    """How finely time is divided.

    :param rate: physics steps per second, a multiple of the control rate
    :param solver_iterations: of the physics engine's constraint solver, per physics step
    :param control_rate: control ticks per second; the paper's pattern generator ran at 100
    """

    rate: int = 300
    solver_iterations: int = 40
    control_rate: int = 100

    def __post_init__(self) -> None:
        """Refuse rates that do not divide into each other."""
        if not SLOWEST_CONTROL_RATE <= self.control_rate <= FASTEST_CONTROL_RATE:
            raise ConfigurationError(
                f"physics.control_rate must be between {SLOWEST_CONTROL_RATE} and {FASTEST_CONTROL_RATE} Hz, "
                f"not {self.control_rate!r}"
            )
        if self.rate < self.control_rate or self.rate % self.control_rate:
            raise ConfigurationError(
                f"physics.rate must be a multiple of the control rate, {self.control_rate} Hz, not {self.rate!r}"
            )
        if self.solver_iterations < 1:
            raise ConfigurationError(f"physics.solver_iterations must be at least 1, not {self.solver_iterations!r}")

    def at_control_rate(self, control_rate: int) -> Physics:
        """The same physics for another control rate; its own rate is raised to the next multiple of that.

        :param control_rate: control ticks per second
        """
        multiple = -(-self.rate // control_rate)
        return Physics(multiple * control_rate, self.solver_iterations, control_rate)

    @property
    def control_dt(self) -> float:
        """Duration of a control tick, in s."""
        return 1.0 / self.control_rate


PHYSICS = {"standard": Physics(), "reference": Physics(rate=1000, solver_iterations=100)}
"""Named settings: what training uses, and the finer one that published results are checked with."""


@dataclass(frozen=True)
class Randomisation:
    """What nobody knows exactly about a robot, drawn for each episode from its seed.

    Parameters learned on one exact robot exploit it, so they must hold under a little of everything. The ranges
    are reconstructed, the paper gives none. A pair is a uniform range; equal ends fix the value.

    :param enabled: whether to randomise; off leaves the robot as designed, with a random start velocity only
    :param friction: Coulomb friction coefficient between sole and floor
    :param mass_deviation: largest relative deviation of each link's mass and inertia
    :param actuator_bandwidth: of the position servos, per second
    :param pad_threshold: pad load above which a foot counts as carrying, in N
    :param acceleration_noise: standard deviation of the accelerometer's white noise, in m/s^2
    :param angular_rate_noise: standard deviation of the gyroscope's white noise, in rad/s
    :param imu_bandwidth: of the first-order low-pass inside the inertial measurement unit, in Hz
    :param pad_noise: standard deviation of each pressure pad's white noise, in N
    :param delay_ticks: control ticks of delay between sensing and acting
    :param start_speed: standard deviation of the torso's velocity along x and y at the start, in m/s
    """

    enabled: bool = True
    friction: tuple[float, float] = (0.7, 1.0)
    mass_deviation: float = 0.05
    actuator_bandwidth: tuple[float, float] = (40.0, 50.0)
    pad_threshold: tuple[float, float] = (20.0, 40.0)
    acceleration_noise: float = 0.2
    angular_rate_noise: float = 0.02
    imu_bandwidth: float = 40.0
    pad_noise: float = 3.0
    delay_ticks: int = 1
    start_speed: float = 0.01

    def __post_init__(self) -> None:
        """Refuse ranges that no robot has."""
        _refuse_impossible_ranges(self, "randomisation")
        if self.mass_deviation >= 1.0:
            raise ConfigurationError(f"randomisation.mass_deviation must be below 1, not {self.mass_deviation!r}")
        for name, value in (("actuator_bandwidth", self.actuator_bandwidth[0]), ("imu_bandwidth", self.imu_bandwidth)):
            if value == 0.0:
                raise ConfigurationError(f"randomisation.{name} must be above 0")


@dataclass(frozen=True)
class Push:
    """The push of the balance task, drawn for each episode from its seed. Equal ends of a range fix the value.

    It acts on the torso's centre, horizontally and with constant force.

    :param newtons: uniform range of the force; the paper's is up to 100 N
    :param degrees: uniform range of the direction: 0 pushes to the robot's right, 90 forward
    :param at_seconds: uniform range of when it begins; the paper's is after the first second
    :param duration: in s
    """

    newtons: tuple[float, float] = (0.0, 100.0)
    degrees: tuple[float, float] = (0.0, 360.0)
    at_seconds: tuple[float, float] = (1.0, 4.0)
    duration: float = 0.15

    def __post_init__(self) -> None:
        """Refuse what is no push, or comes while the robot is still held to be standing."""
        _refuse_impossible_ranges(self, "push")
        if self.at_seconds[0] < STAND_SECONDS:
            raise ConfigurationError(f"push.at_seconds must be from {STAND_SECONDS:g} s on, not {self.at_seconds!r}")


def _refuse_impossible_ranges(config: Any, key: str) -> None:
    for item in fields(config):
        value = getattr(config, item.name)
        low, high = value if isinstance(value, tuple) else (value, value)
        if not 0.0 <= low <= high < math.inf:
            raise ConfigurationError(
                f"{key}.{item.name} must be finite, not negative and in rising order, not {value!r}"
            )


@dataclass(frozen=True)
class EpisodeConfig:
    """What all episodes of an experiment share.

    :param physics: how finely to integrate
    :param randomisation: what to draw from each episode's seed
    :param dimensions: of the robot, where they differ from the xacro's defaults
    :param time_limit: of an episode, in s; the paper's first criterion
    :param reward_form: ``"symmetric"``, or ``"printed"`` for equation 2 to the letter
    :param stepping: P1 to P5 of the balance task, which the agent does not choose there
    :param push: of the balance task
    """

    physics: Physics = PHYSICS["standard"]
    randomisation: Randomisation = Randomisation()
    dimensions: Mapping[str, float] = field(default_factory=dict)
    time_limit: float = 30.0
    reward_form: RewardForm = "symmetric"
    stepping: tuple[float, float, float, float, float] = TRAINED_STEPPING
    push: Push = Push()

    def __post_init__(self) -> None:
        """Refuse what cannot be simulated."""
        if not STAND_SECONDS < self.time_limit < math.inf:
            raise ConfigurationError(
                f"time_limit must be finite and above {STAND_SECONDS:g} s, not {self.time_limit!r}"
            )
        if self.reward_form not in get_args(RewardForm):
            raise ConfigurationError(unknown_name("reward_form", self.reward_form, get_args(RewardForm)))
        STEPPING.checked(self.stepping, "stepping")
        if self.push.duration < self.physics.control_dt:
            tick = f"a control tick, {self.physics.control_dt:g} s"
            raise ConfigurationError(f"push.duration must be at least {tick}, not {self.push.duration!r}")


@dataclass(frozen=True)
class TrainingConfig:
    """A training: what ``sarah-train`` does.

    :param task: what to learn: ``stepping`` is the paper's first training, P1 to P5, and ``balance`` its
        second, V1 to V4
    :param algo: what learns: ``naf``, stable-baselines3's ``td3``, ``sac`` or ``ddpg``, or an optimiser that only sees
        returns: ``cma-es``, ``gp`` (Gaussian process), ``tpe`` or ``random``
    :param simulations: budget; every simulation is one action of the agent and up to 30 s of the robot
    :param seed: of the training and of all its episodes
    :param slots: episodes in flight: each action is chosen knowing all outcomes but those of the slots - 1 before
        it. Another number is another training; the number of workers is not
    :param episode: settings of the episodes
    """

    task: str = "stepping"
    algo: str = "naf"
    simulations: int = 100
    seed: int = 0
    slots: int = 4
    episode: EpisodeConfig = EpisodeConfig()

    def __post_init__(self) -> None:
        """Refuse unknown names and impossible budgets."""
        if self.task not in TASKS:
            raise ConfigurationError(unknown_name("task", self.task, TASKS))
        if self.algo not in ALGORITHMS:
            raise ConfigurationError(unknown_name("algo", self.algo, ALGORITHMS))
        if self.simulations < 1:
            raise ConfigurationError(f"simulations must be at least 1, not {self.simulations!r}")
        if self.slots < 1:
            raise ConfigurationError(f"slots must be at least 1, not {self.slots!r}")
        if not 0 <= self.seed < 2**31:
            raise ConfigurationError(f"seed must be between 0 and {2**31 - 1}, not {self.seed!r}")
        push, limit = self.episode.push, self.episode.time_limit
        if self.task != BALANCE.name and push != Push():
            raise ConfigurationError(f"episode.push is for task {BALANCE.name!r}: {self.task!r} has no push")
        if self.task == BALANCE.name and push.at_seconds[0] >= limit:
            raise ConfigurationError(
                f"episode.push.at_seconds must begin before the time_limit of {limit:g} s, not {push.at_seconds!r}"
            )


def first_difference(config: Any, other: Any, key: str = "") -> tuple[str, Any, Any] | None:
    """Where two configurations of a kind differ.

    :param config: a dataclass of this module
    :param other: another one
    :param key: what the names begin with
    :return: the key and both values; nothing if they are equal
    """
    for item in fields(config):
        value, there = getattr(config, item.name), getattr(other, item.name)
        if value == there:
            continue
        if dataclasses.is_dataclass(value):
            return first_difference(value, there, f"{key}{item.name}.")
        return key + item.name, value, there
    return None


def read_config(config_type: type[ConfigType], path: Path) -> ConfigType:
    """Read a configuration from a YAML file. What the file does not name keeps its default.

    :param config_type: the dataclass to make
    :param path: of the file
    :raises ConfigurationError: naming file, key and value, if something in it is not allowed
    """
    import yaml

    try:
        content = yaml.safe_load(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError) as error:
        raise ConfigurationError(f"cannot read {path}: {getattr(error, 'strerror', None) or error}") from error
    except yaml.YAMLError as error:
        raise ConfigurationError(f"{path} is not YAML: {' '.join(str(error).split())}") from error
    try:
        return _from_mapping(config_type, {} if content is None else content, "")
    except ConfigurationError as error:
        raise ConfigurationError(f"{path}: {error}") from error


def write_config(config: Any, path: Path) -> None:
    """Write a configuration as YAML, every value spelled out, so that :func:`read_config` gives it back.

    :param config: a dataclass of this module
    :param path: of the file
    """
    import yaml

    replace_text(path, yaml.safe_dump(_to_plain(dataclasses.asdict(config)), sort_keys=False))


def _to_plain(value: Any) -> Any:
    """YAML's own types only: safe loaders refuse tuples."""
    if isinstance(value, Mapping):
        return {key: _to_plain(item) for key, item in value.items()}
    return [_to_plain(item) for item in value] if isinstance(value, tuple) else value


def _from_mapping(config_type: type[ConfigType], content: Any, key: str) -> ConfigType:
    if not isinstance(content, Mapping):
        raise ConfigurationError(f"{key or 'the file'} must hold keys and values, not {content!r}")
    types = get_type_hints(config_type)
    values = {}
    for name, value in content.items():
        if name not in types:
            raise ConfigurationError(unknown_name("key", f"{key}{name}", (key + allowed for allowed in types)))
        values[name] = _converted(types[name], value, key + name)
    return config_type(**values)


def _converted(expected: Any, value: Any, key: str) -> Any:
    """A value of the expected type, or an error that names the key."""
    if dataclasses.is_dataclass(expected):
        return _from_mapping(expected, value, f"{key}.")  # type: ignore[arg-type]
    if get_origin(expected) is tuple:
        parts = get_args(expected)
        if not isinstance(value, (list, tuple)) or len(value) != len(parts):
            raise ConfigurationError(f"{key} must be a list of {len(parts)} values, not {value!r}")
        return tuple(_converted(part, item, key) for part, item in zip(parts, value, strict=True))
    if get_origin(expected) is Mapping:
        if not isinstance(value, Mapping):
            raise ConfigurationError(f"{key} must hold names and values, not {value!r}")
        return {name: _converted(get_args(expected)[1], item, f"{key}.{name}") for name, item in value.items()}
    allowed = {float: (float, int), int: (int,), bool: (bool,)}.get(expected, (str,))
    if not isinstance(value, allowed) or (isinstance(value, bool) and expected is not bool):
        kind = {float: "a number", int: "a whole number", bool: "true or false"}.get(expected, "a text")
        raise ConfigurationError(f"{key} must be {kind}, not {value!r}")
    return float(value) if expected is float else value
