"""What an experiment's settings are: plain dataclasses.

Light on purpose: commands import it before anything slow.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from typing import Any, Literal, get_args

from sarah.errors import ConfigurationError, check_range, shortened, unknown_name
from sarah.tasks import BALANCE, STEPPING, TASKS

STAND_SECONDS = 1.0
"""How long the robot stands before the pattern generator starts; the paper's."""
SLOWEST_CONTROL_RATE, FASTEST_CONTROL_RATE = 50, 1000
FASTEST_PHYSICS_RATE = 20_000
MOST_SOLVER_ITERATIONS = 10_000
LARGEST_ADDED_INERTIA = 1.0
LONGEST_EPISODE = 3600.0
MOST_SIMULATIONS = 1_000_000
MOST_SLOTS = 10_000
SEEDS = 2**31
"""Seeds of trainings are below; those of their episodes from here on."""
PLAUSIBLE: dict[str, tuple[float, float, str]] = {
    "friction": (0.0, 5.0, ""),
    "mass_deviation": (0.0, 0.9, ""),
    "actuator_bandwidth": (0.1, 1000.0, "per second"),
    "pad_threshold": (0.0, 1000.0, "N"),
    "acceleration_noise": (0.0, 100.0, "m/s^2"),
    "angular_rate_noise": (0.0, 100.0, "rad/s"),
    "imu_bandwidth": (0.1, 100_000.0, "Hz"),
    "pad_noise": (0.0, 1000.0, "N"),
    "delay_ticks": (0, 100, "ticks"),
    "start_speed": (0.0, 10.0, "m/s"),
    "newtons": (0.0, 10_000.0, "N"),
    "degrees": (0.0, 720.0, "degrees"),
    "at_seconds": (STAND_SECONDS, LONGEST_EPISODE, "s"),
    "duration": (0.0, 10.0, "s"),
}
"""Of randomisation and push: lowest and highest value that a robot or a push can have, and its unit. Beyond, somebody
has mistaken the unit."""
TRAINED_STEPPING = (0.41, 0.52, 0.62, 1.17, 1.37)
"""P1 to P5 that the balance task keeps unless others are given: what NAF learned once, to two digits."""

SIMULATIONS_PER_CANDIDATE = 5
"""In the comparison that ends a training."""
BUDGET_PER_CANDIDATE = 50
"""Simulations of the whole training for each candidate: a tenth of them goes into the comparison."""

AGENTS = ("naf", "td3", "sac", "ddpg")
"""Learn by reinforcement, with networks."""
SEARCHERS = ("cma-es", "gp", "tpe", "random")
"""Black-box optimisers."""
ALGORITHMS = AGENTS + SEARCHERS
Engine = Literal["pybullet", "mujoco"]
RewardForm = Literal["symmetric", "printed"]


@dataclass(frozen=True)
class Physics:
    """How finely time is divided.

    :param rate: physics steps per second, a multiple of the control rate; MuJoCo takes at least 300
    :param solver_iterations: of the physics engine's constraint solver, per physics step
    :param control_rate: control ticks per second; the paper's pattern generator ran at 100
    :param added_plate_inertia: which PyBullet gives each foot plate about its hinge while its leg is not retracted, in
        kg m^2. It makes few solver iterations enough; 0 is the robot as it is
    """

    rate: int = 200
    solver_iterations: int = 32
    control_rate: int = 100
    added_plate_inertia: float = 0.008

    def __post_init__(self) -> None:
        """Refuse rates that do not divide into each other."""
        check_range("physics.control_rate", self.control_rate, SLOWEST_CONTROL_RATE, FASTEST_CONTROL_RATE, "Hz")
        check_range("physics.rate", self.rate, self.control_rate, FASTEST_PHYSICS_RATE, "Hz")
        if self.rate % self.control_rate:
            raise ConfigurationError(
                f"physics.rate must be a multiple of the control rate, {self.control_rate} Hz, not {self.rate!r}"
            )
        check_range("physics.solver_iterations", self.solver_iterations, 1, MOST_SOLVER_ITERATIONS)
        check_range("physics.added_plate_inertia", self.added_plate_inertia, 0.0, LARGEST_ADDED_INERTIA, "kg m^2")

    def at_control_rate(self, control_rate: int) -> Physics:
        """The same physics for another control rate; its own rate is raised to the next multiple of that.

        :param control_rate: control ticks per second
        """
        multiple = -(-self.rate // control_rate)
        return replace(self, rate=multiple * control_rate, control_rate=control_rate)

    @property
    def control_dt(self) -> float:
        """Duration of a control tick, in s."""
        return 1.0 / self.control_rate


PHYSICS = {"standard": Physics(), "reference": Physics(1000, 100, added_plate_inertia=0.0)}
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
        _check_plausible(self, "randomisation")


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
        _check_plausible(self, "push")


def _check_plausible(config: Any, key: str) -> None:
    for item in fields(config):
        if item.name in PLAUSIBLE:
            check_range(f"{key}.{item.name}", getattr(config, item.name), *PLAUSIBLE[item.name])


@dataclass(frozen=True)
class EpisodeConfig:
    """What all episodes of an experiment share.

    :param physics: how finely to integrate
    :param engine: what integrates: ``"pybullet"``, the reference, or ``"mujoco"``
    :param randomisation: what to draw from each episode's seed
    :param dimensions: of the robot, names and values where they differ from the xacro's; by default none do
    :param time_limit: of an episode, in s; the paper's first criterion
    :param reward_form: ``"symmetric"``, or ``"printed"`` for equation 2 to the letter
    :param stepping: P1 to P5 of the balance task, which the agent does not choose there
    :param push: of the balance task
    """

    physics: Physics = PHYSICS["standard"]
    engine: Engine = "pybullet"
    randomisation: Randomisation = Randomisation()
    dimensions: Mapping[str, float] = field(default_factory=dict)
    time_limit: float = 30.0
    reward_form: RewardForm = "symmetric"
    stepping: tuple[float, float, float, float, float] = TRAINED_STEPPING
    push: Push = Push()

    def __post_init__(self) -> None:
        """Refuse what cannot be simulated."""
        if self.engine not in get_args(Engine):
            raise ConfigurationError(unknown_name("engine", self.engine, get_args(Engine)))
        check_range("time_limit", self.time_limit, STAND_SECONDS, LONGEST_EPISODE, "s")
        if self.time_limit < STAND_SECONDS + self.physics.control_dt:
            raise ConfigurationError(
                f"time_limit must be above the {STAND_SECONDS:g} s of standing, not {self.time_limit!r}"
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
        check_range("simulations", self.simulations, 1, MOST_SIMULATIONS)
        check_range("slots", self.slots, 1, MOST_SLOTS)
        if not 0 <= self.seed < SEEDS:
            raise ConfigurationError(f"seed must be between 0 and {SEEDS - 1}, not {shortened(self.seed)}")
        push, limit = self.episode.push, self.episode.time_limit
        if self.task != BALANCE.name and push != Push():
            raise ConfigurationError(f"episode.push is for task {BALANCE.name!r}: {self.task!r} has no push")
        if self.task == BALANCE.name and push.at_seconds[0] >= limit:
            raise ConfigurationError(
                f"episode.push.at_seconds must begin before the time_limit of {limit:g} s, not {push.at_seconds!r}"
            )

    @property
    def candidate_count(self) -> int:
        """How many candidates the budget affords to compare at the end; with one, there is nothing to compare."""
        return max(1, self.simulations // BUDGET_PER_CANDIDATE)

    @property
    def compared_simulations(self) -> int:
        """How many simulations the comparison of candidates takes, at the end of the budget."""
        return self.candidate_count * SIMULATIONS_PER_CANDIDATE if self.candidate_count > 1 else 0
