"""Policy of NAF: the critic, its target copy and their optimizer."""

from typing import Any, ClassVar

import numpy as np
import torch as th
from gymnasium import spaces
from stable_baselines3.common.policies import BasePolicy
from stable_baselines3.common.torch_layers import (
    BaseFeaturesExtractor,
    CombinedExtractor,
    FlattenExtractor,
    NatureCNN,
)
from stable_baselines3.common.type_aliases import PyTorchObs, Schedule
from torch import nn

from sarah.agents.arguments import checked_number
from sarah.agents.critic import QuadraticCritic
from sarah.agents.unknown_arguments import explains_unknown


class NAFPolicy(BasePolicy):
    """
    Policy class with a quadratic critic and its target network for NAF.

    :param observation_space: Observation space
    :param action_space: Action space
    :param lr_schedule: Learning rate schedule (could be constant)
    :param net_arch: Hidden layers. A list is for those of the values, and for those that ``mu`` and ``L`` share
        (``[256, 256]`` by default, as SAC's). With ``dict(W=[...], mu=[...], L=[...])`` each has layers of its own,
        where ``V`` and ``W`` are outputs of the same layers; with the key ``shared`` as well, those of ``mu`` and ``L``
        follow layers in common. With ``V`` in place of ``W`` there is no ``W``, and targets take the value of the best
        action, as in the publication: for tasks of one step or one action. Then layers are plain, and
        ``dropout`` has no effect
    :param activation_fn: Activation function (ReLU by default). Tanh suits smooth tasks of one step,
        but fails where values are large; with sigmoid, deeper networks hardly learn.
    :param features_extractor_class: Features extractor to use, by default that of the class
    :param features_extractor_kwargs: Keyword arguments
        to pass to the features extractor.
    :param normalize_images: Whether to normalize images or not,
         dividing by 255.0 (True by default)
    :param optimizer_class: The optimizer to use,
        ``th.optim.Adam`` by default
    :param optimizer_kwargs: Additional keyword arguments,
        excluding the learning rate, to pass to the optimizer
    :param squash_mu: Whether ``mu`` ends in a tanh (True by default). If not, it is linear,
        as in the original paper, and the policy clips it to the action space.
    :param dropout: Share of the units that an update leaves out of each hidden layer of ``mu`` and ``L`` (0.2 by
        default). Without it the parabola learns noise by heart, which makes it too steep.
    :param min_curvature: Curvature of ``Q`` that is added in all directions of the action (0 by default). Where it is
        flat ``mu`` gets no gradient: without it, ``mu`` may stay wrong in a direction that ``L`` makes flat to fit.
    """

    default_features_extractor: ClassVar[type[BaseFeaturesExtractor]] = FlattenExtractor
    action_space: spaces.Box
    q_net: QuadraticCritic
    q_net_target: QuadraticCritic

    @explains_unknown
    def __init__(
        self,
        observation_space: spaces.Space,
        action_space: spaces.Box,
        lr_schedule: Schedule,
        net_arch: list[int] | dict[str, list[int]] | None = None,
        activation_fn: type[nn.Module] = nn.ReLU,
        features_extractor_class: type[BaseFeaturesExtractor] | None = None,
        features_extractor_kwargs: dict[str, Any] | None = None,
        normalize_images: bool = True,
        optimizer_class: type[th.optim.Optimizer] = th.optim.Adam,
        optimizer_kwargs: dict[str, Any] | None = None,
        squash_mu: bool = True,
        dropout: float = 0.2,
        min_curvature: float = 0.0,
    ) -> None:
        if optimizer_kwargs is None and optimizer_class is th.optim.Adam:
            optimizer_kwargs = dict(fused=True)  # Several times faster on networks as small as these

        super().__init__(
            observation_space,
            action_space,
            features_extractor_class or self.default_features_extractor,
            features_extractor_kwargs,
            optimizer_class=optimizer_class,
            optimizer_kwargs=optimizer_kwargs,
            squash_output=True,
            normalize_images=normalize_images,
        )
        if not isinstance(squash_mu, bool):
            raise ValueError(f"squash_mu must be True or False, not {squash_mu!r}")
        min_curvature = checked_number("min_curvature", min_curvature, 0.0)
        dropout = checked_number("dropout", dropout, 0.0, 0.9)
        if net_arch is None:
            net_arch = [256, 256]
        if not isinstance(net_arch, list | tuple | dict):
            raise ValueError(f"net_arch must be a list of widths or a dict of lists, not {net_arch!r}")
        if not isinstance(net_arch, dict):
            net_arch = dict(W=net_arch, shared=net_arch, mu=[], L=[])
        if set(net_arch) - {"shared"} not in ({"W", "mu", "L"}, {"V", "mu", "L"}):
            raise ValueError(
                f"net_arch must be a list or have the keys W or V, mu and L and perhaps shared, not {sorted(net_arch)}"
            )
        for name, widths in net_arch.items():
            if not isinstance(widths, list | tuple):
                raise ValueError(f"net_arch[{name!r}] must be a list of widths, not {widths!r}")
            where = f"a width in net_arch[{name!r}]"
            net_arch = {**net_arch, name: [checked_number(where, width, 1, whole=True) for width in widths]}

        self.net_args: dict[str, Any] = {
            "observation_space": self.observation_space,
            "action_space": self.action_space,
            "net_arch": {"shared": [], **net_arch},
            "activation_fn": activation_fn,
            "normalize_images": normalize_images,
            "squash_mu": squash_mu,
            "dropout": dropout,
            "min_curvature": min_curvature,
        }

        self._build(lr_schedule)

    def _build(self, lr_schedule: Schedule) -> None:
        """Create the networks and the optimizer, and put the networks into evaluation mode."""
        self.q_net = self.make_q_net()
        self.q_net_target = self.make_q_net()
        self.q_net_target.load_state_dict(self.q_net.state_dict())
        self.q_net_target.set_training_mode(False)
        self.set_training_mode(False)

        self.optimizer = self.optimizer_class(  # type: ignore[call-arg]
            self.q_net.parameters(),
            lr=lr_schedule(1),
            **self.optimizer_kwargs,
        )

    def make_q_net(self) -> QuadraticCritic:
        """
        Create a critic with a features extractor of its own.

        :return: A critic with fresh weights
        """
        net_args = self._update_features_extractor(self.net_args, features_extractor=None)
        return QuadraticCritic(**net_args).to(self.device)

    def forward(self, obs: PyTorchObs, deterministic: bool = True) -> th.Tensor:
        """
        Best actions.

        :param obs: Observations
        :param deterministic: Without effect: exploration is added by the algorithm
        :return: Actions, scaled to [-1, 1]
        """
        return self._predict(obs, deterministic=deterministic)

    def _predict(self, observation: PyTorchObs, deterministic: bool = True) -> th.Tensor:
        # A linear mu may leave the scaled action space
        return self.q_net.mu(observation).clamp(-1.0, 1.0)

    def unscale_action(self, scaled_action: np.ndarray) -> np.ndarray:
        """
        Rescale the action from [-1, 1] to [low, high], and never beyond them, not even by rounding.

        :param scaled_action: Action to un-scale
        :return: Action in the action space
        """
        return np.clip(super().unscale_action(scaled_action), self.action_space.low, self.action_space.high)

    def _get_constructor_parameters(self) -> dict[str, Any]:
        data = super()._get_constructor_parameters()

        data.update(
            dict(
                self.net_args,
                lr_schedule=self._dummy_schedule,  # dummy lr schedule, not needed for loading policy alone
                optimizer_class=self.optimizer_class,
                optimizer_kwargs=self.optimizer_kwargs,
                features_extractor_class=self.features_extractor_class,
                features_extractor_kwargs=self.features_extractor_kwargs,
            )
        )
        return data

    def set_training_mode(self, mode: bool) -> None:
        """
        Put the policy in either training or evaluation mode.

        This affects certain modules, such as batch normalisation and dropout.
        The target network stays in evaluation mode.

        :param mode: if true, set to training mode, else set to evaluation mode
        """
        self.q_net.set_training_mode(mode)
        self.training = mode


MlpPolicy = NAFPolicy


class CnnPolicy(NAFPolicy):
    """
    Policy class for NAF when using images as input; its arguments are those of :class:`NAFPolicy`.
    """

    default_features_extractor = NatureCNN


class MultiInputPolicy(NAFPolicy):
    """
    Policy class for NAF when using dict observations as input; its arguments are those of :class:`NAFPolicy`.
    """

    default_features_extractor = CombinedExtractor
