"""Settings of the algorithms: a dataclass for each, found by name in :data:`AGENT_SETTINGS`.

Light on purpose: commands import it before anything slow, so it knows no learner.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field, replace
from typing import Annotated, Any, Literal

from sarah.episode.from_mapping import convert_fields
from sarah.errors import ConfigurationError, shortened, unknown_name
from sarah.ranges import Within, check_ranges

Preset = Literal["one-step", "noisy", "paper"]
Activation = Literal["tanh", "relu", "sigmoid"]

ONE_STEP: dict[str, Any] = dict(
    temperature=4.0,
    smoothed=True,
    elite_share=0.8,
    elite_std=(0.4, 0.15),
    elite_end=0.8,
    v_layers=(32, 32),
    mu_layers=(32, 32),
    l_layers=(32, 32),
    activation="tanh",
    squash_mu=True,
    min_curvature=1.0,
)
PRESETS: dict[str, dict[str, Any]] = {
    "one-step": ONE_STEP,
    "noisy": ONE_STEP | dict(temperature=8.0, elite_std=(1.2, 0.15)),
    "paper": dict(
        temperature=0.0,
        smoothed=False,
        elite_share=0.0,
        elite_std=(0.4, 0.15),
        elite_end=0.8,
        v_layers=(256, 256, 256),
        mu_layers=(16, 16, 16, 16),
        l_layers=(80, 80, 80, 80),
        activation="sigmoid",
        squash_mu=False,
        min_curvature=0.0,
    ),
}
"""Defaults of NAF that a preset decides: local NAF, for returns without much noise or with much, or plain NAF with
the paper's networks."""

WARM_UP = 5
"""Default number of episodes before an algorithm uses what it knows: the same for all, which makes races fair."""
Share = Annotated[float, Within(0.0, 1.0)]
Deviation = Annotated[float, Within(0.0, 2.0)]
LearningRate = Annotated[float, Within(1e-9, 1.0)]
BufferSize = Annotated[int, Within(1, 10_000_000)]
Layers = tuple[Annotated[int, Within(1, 10_000)], ...]


@dataclass(frozen=True)
class AgentSettings:
    """Settings of an algorithm; by itself, those of one that has none."""

    def __post_init__(self) -> None:
        """Refuse values of another type or out of their range."""
        convert_fields(self, "agent.")
        check_ranges("agent.", self)


@dataclass(frozen=True)
class LearnerSettings(AgentSettings):
    """Settings that all reinforcement learners share. Actions are scaled to [-1, 1].

    :param learning_rate: step size of the optimiser Adam
    :param buffer_size: number of episodes that the replay buffer holds
    :param learning_starts: number of random episodes before the networks learn; twice the slots, if that is more
    :param batch_size: number of episodes in the minibatch of an update
    :param tau: share of the new weights that the target networks take over at an update
    :param gamma: discount factor; without effect, because an episode is one action
    :param gradient_steps: number of updates after each episode
    :param device: device of the networks: cpu, cuda, cuda:1 and so on, or auto, which takes CUDA where there is some
    """

    learning_rate: LearningRate = 1e-3
    buffer_size: BufferSize = 1_000_000
    learning_starts: Annotated[int, Within(0, 1_000_000)] = WARM_UP
    batch_size: Annotated[int, Within(1, 100_000)] = 64
    tau: Share = 0.005
    gamma: Share = 0.0
    gradient_steps: Annotated[int, Within(1, 10_000)] = 10
    device: str = "cpu"

    def __post_init__(self) -> None:
        """Refuse values out of their range, and devices that torch has not."""
        super().__post_init__()
        if not re.fullmatch(r"cpu|cuda(:[0-9]{1,3})?|auto", self.device):
            raise ConfigurationError(
                f"agent.device must be 'cpu', 'cuda', 'cuda:' and a number, or 'auto', not {shortened(self.device)}"
            )


def _by_preset() -> Any:
    """A field's default that the preset decides."""
    return field(default=None)


@dataclass(frozen=True)
class NAFSettings(LearnerSettings):
    """Settings of NAF. Standard deviations are of actions scaled to [-1, 1].

    :param preset: source of defaults: one-step for local NAF, noisy for local NAF where chance decides more of a return
        than the parameters do, paper for the paper's networks and plain NAF
    :param max_grad_norm: largest norm of an update's gradient
    :param exploration_std: standard deviation of the noise around mu: at first, and after 80 % of the training
    :param temperature: logarithm of how much more often the best episode is replayed than the worst
    :param smoothed: smoothing of the returns over similar actions, by a Gaussian process of the newest 500 episodes
    :param elite_share: share of the actions that are drawn around the best one so far instead of around mu
    :param elite_std: standard deviation of these draws: at first, and when they are narrowest
    :param elite_end: share of the training after which these draws are narrowest
    :param elite_draws: number of draws, of which the most promising is tried
    :param v_layers: widths of the hidden layers of V
    :param mu_layers: widths of the hidden layers of mu
    :param l_layers: widths of the hidden layers of L
    :param shared_layers: widths of hidden layers that mu and L have in common, before their own
    :param activation: activation function of the hidden layers: tanh, relu or sigmoid
    :param squash_mu: tanh at the end of mu; if there is none, mu is linear and clipped
    :param min_curvature: curvature that is added to L L^T, so that Q is flat nowhere
    """

    buffer_size: BufferSize = 10_000
    tau: Share = 0.02
    preset: Preset = "one-step"
    max_grad_norm: Annotated[float, Within(1e-6, 1e6)] = 10.0
    exploration_std: tuple[Deviation, Deviation] = (0.3, 0.05)
    temperature: Annotated[float, Within(0.0, 100.0)] = _by_preset()
    smoothed: bool = _by_preset()
    elite_share: Share = _by_preset()
    elite_std: tuple[Deviation, Deviation] = _by_preset()
    elite_end: Annotated[float, Within(0.01, 1.0)] = _by_preset()
    elite_draws: Annotated[int, Within(1, 10_000)] = 1
    v_layers: Layers = _by_preset()
    mu_layers: Layers = _by_preset()
    l_layers: Layers = _by_preset()
    shared_layers: Layers = ()
    activation: Activation = _by_preset()
    squash_mu: bool = _by_preset()
    min_curvature: Annotated[float, Within(0.0, 1000.0)] = _by_preset()

    def __post_init__(self) -> None:
        """Take what is not given from the preset, and refuse unknown names and values out of their range."""
        for name, value in PRESETS.get(self.preset, {}).items():
            if getattr(self, name) is None:
                object.__setattr__(self, name, value)
        super().__post_init__()
        if self.gamma > 0 and (self.temperature > 0 or self.elite_share > 0):
            raise ConfigurationError(
                f"agent.gamma must be 0 unless agent.temperature and agent.elite_share are 0, not {self.gamma:g}"
            )

    def with_preset(self, preset: str) -> NAFSettings:
        """Settings with everything that a preset decides; the others stay.

        :param preset: name of the preset
        """
        undecided: dict[str, Any] = dict.fromkeys(PRESETS["one-step"])
        return replace(self, preset=preset, **undecided)  # type: ignore[arg-type]  # the name is checked


@dataclass(frozen=True)
class DDPGSettings(LearnerSettings):
    """Settings of stable-baselines3's DDPG. Standard deviations are of actions scaled to [-1, 1].

    :param layers: widths of the hidden layers of actor and critic
    :param action_noise_std: standard deviation of the exploration noise
    """

    layers: Layers = (64, 64)
    action_noise_std: Deviation = 0.2


@dataclass(frozen=True)
class TD3Settings(DDPGSettings):
    """Settings of stable-baselines3's TD3. Standard deviations are of actions scaled to [-1, 1].

    :param policy_delay: number of updates of the critics to one of the actor
    :param target_policy_noise: standard deviation of the noise on actions that targets are computed with
    :param target_noise_clip: largest absolute value of that noise
    """

    policy_delay: Annotated[int, Within(1, 100)] = 2
    target_policy_noise: Deviation = 0.2
    target_noise_clip: Deviation = 0.5


@dataclass(frozen=True)
class SACSettings(LearnerSettings):
    """Settings of stable-baselines3's SAC.

    :param layers: widths of the hidden layers of actor and critics
    :param ent_coef: coefficient of the entropy, or auto, which learns it
    """

    learning_rate: LearningRate = 3e-4
    layers: Layers = (64, 64)
    ent_coef: Annotated[float, Within(0.0, 100.0)] | Literal["auto"] = "auto"


@dataclass(frozen=True)
class EvolutionSettings(AgentSettings):
    """Settings of CMA-ES.

    :param deviation: standard deviation of the first generation, in actions scaled to [-1, 1]
    :param population: number of episodes in a generation
    """

    deviation: Annotated[float, Within(0.01, 2.0)] = 0.6
    population: Annotated[int, Within(2, 1000)] = 8


AGENT_SETTINGS: dict[str, type[AgentSettings]] = {
    "naf": NAFSettings,
    "td3": TD3Settings,
    "sac": SACSettings,
    "ddpg": DDPGSettings,
    "cma-es": EvolutionSettings,
    "gp": AgentSettings,
    "tpe": AgentSettings,
    "random": AgentSettings,
}
"""Settings of every algorithm, by its name."""


def settings_of(algo: str) -> type[AgentSettings]:
    """Class of an algorithm's settings.

    :param algo: name of the algorithm
    :raises ConfigurationError: for an unknown one
    """
    if not isinstance(algo, str) or algo not in AGENT_SETTINGS:
        raise ConfigurationError(unknown_name("algo", str(algo), AGENT_SETTINGS))
    return AGENT_SETTINGS[algo]
