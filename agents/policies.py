"""Policy of NAF: the networks V, mu and L behind one quadratic action value, and its target copy."""

from typing import Any

import numpy as np
import torch as th
from gymnasium import spaces
from stable_baselines3.common.policies import BaseModel, BasePolicy
from stable_baselines3.common.preprocessing import get_action_dim
from stable_baselines3.common.torch_layers import (
    BaseFeaturesExtractor,
    CombinedExtractor,
    FlattenExtractor,
    NatureCNN,
    create_mlp,
)
from stable_baselines3.common.type_aliases import PyTorchObs, Schedule
from torch import nn

LOG_DIAGONAL_MIN = -5.0
LOG_DIAGONAL_MAX = 5.0


class QuadraticCritic(BaseModel):
    r"""
    Action value that is quadratic in the action (Gu et al. 2016, https://arxiv.org/abs/1603.00748):

    .. math:: Q(s, u) = V(s) - \frac{1}{2} (u - \mu(s))^T L(s) L(s)^T (u - \mu(s))

    ``L`` is lower triangular with a positive diagonal, so ``L L^T`` is positive definite: ``mu`` is the best
    action and ``V`` its value, without a search. The three heads are separate networks on one features
    extractor: with layers that they share, more seeds of Pendulum fail. Actions are scaled to [-1, 1]. The output
    layer of ``mu`` starts at zero: an untrained critic proposes the centre of the action space whatever it observes.

    :param observation_space: Observation space
    :param action_space: Action space
    :param features_extractor: Network to extract features
        (a CNN when using images, a nn.Flatten() layer otherwise)
    :param features_dim: Number of features
    :param net_arch: Hidden layers of each head, by name: ``V``, ``mu`` and ``L``
    :param activation_fn: Activation function
    :param normalize_images: Whether to normalize images or not,
         dividing by 255.0 (True by default)
    :param squash_mu: Whether ``mu`` ends in a tanh; if not, it is linear and may leave [-1, 1]
    :param lower_sees_action: Whether ``L`` also reads the action, see :class:`NAFPolicy`
    """

    action_space: spaces.Box
    features_extractor: BaseFeaturesExtractor
    rows: th.Tensor
    columns: th.Tensor
    in_column: th.Tensor
    is_diagonal: th.Tensor

    def __init__(
        self,
        observation_space: spaces.Space,
        action_space: spaces.Box,
        features_extractor: BaseFeaturesExtractor,
        features_dim: int,
        net_arch: dict[str, list[int]],
        activation_fn: type[nn.Module] = nn.ReLU,
        normalize_images: bool = True,
        squash_mu: bool = True,
        lower_sees_action: bool = False,
    ) -> None:
        super().__init__(
            observation_space,
            action_space,
            features_extractor=features_extractor,
            normalize_images=normalize_images,
        )
        self.lower_sees_action = lower_sees_action

        action_dim = get_action_dim(action_space)
        rows, columns = th.tril_indices(action_dim, action_dim)
        # Where in L its entries are, row by row
        self.register_buffer("rows", rows, persistent=False)
        self.register_buffer("columns", columns, persistent=False)
        self.register_buffer("in_column", nn.functional.one_hot(columns, action_dim).float(), persistent=False)
        self.register_buffer("is_diagonal", rows == columns, persistent=False)

        lower_input_dim = features_dim + action_dim * lower_sees_action
        self.value_net = nn.Sequential(*create_mlp(features_dim, 1, net_arch["V"], activation_fn))
        self.mu_net = nn.Sequential(*create_mlp(features_dim, action_dim, net_arch["mu"], activation_fn, squash_mu))
        self.lower_net = nn.Sequential(*create_mlp(lower_input_dim, len(rows), net_arch["L"], activation_fn))

        mu_output = [layer for layer in self.mu_net if isinstance(layer, nn.Linear)][-1]
        nn.init.zeros_(mu_output.weight)
        nn.init.zeros_(mu_output.bias)

    def forward(self, obs: PyTorchObs, actions: th.Tensor) -> tuple[th.Tensor, th.Tensor]:
        """
        Value of actions, and the best actions, which a loss may want too.

        :param obs: Observations
        :param actions: Actions, scaled to [-1, 1], of shape (batch, action dim)
        :return: ``Q`` of shape (batch, 1) and ``mu`` of shape (batch, action dim)
        """
        features = self.extract_features(obs, self.features_extractor)
        mu = self.mu_net(features)
        # (u - mu)^T L L^T (u - mu) is the squared length of the row (u - mu)^T L, summed without building L
        projected = ((actions - mu).index_select(1, self.rows) * self._entries(features, actions)) @ self.in_column
        advantage = -0.5 * projected.square().sum(dim=1, keepdim=True)
        return self.value_net(features) + advantage, mu

    def value(self, obs: PyTorchObs) -> th.Tensor:
        """
        Value of the best action, the maximum of ``Q`` over the actions.

        :param obs: Observations
        :return: ``V`` of shape (batch, 1)
        """
        return self.value_net(self.extract_features(obs, self.features_extractor))

    def mu(self, obs: PyTorchObs) -> th.Tensor:
        """
        Best actions, where ``Q`` has its maximum.

        :param obs: Observations
        :return: ``mu`` of shape (batch, action dim), scaled so that the action space is [-1, 1]
        """
        return self.mu_net(self.extract_features(obs, self.features_extractor))

    def lower(self, obs: PyTorchObs, actions: th.Tensor) -> th.Tensor:
        """
        Matrix ``L``, filled row by row, its diagonal the exponential of a clamped output.

        :param obs: Observations
        :param actions: Scaled actions, which count only if ``lower_sees_action``
        :return: ``L`` of shape (batch, action dim, action dim)
        """
        lower = actions.new_zeros(*actions.shape, actions.shape[1])
        features = self.extract_features(obs, self.features_extractor)
        lower[:, self.rows, self.columns] = self._entries(features, actions)
        return lower

    def _entries(self, features: th.Tensor, actions: th.Tensor) -> th.Tensor:
        inputs = th.cat([features, actions], dim=1) if self.lower_sees_action else features
        outputs = self.lower_net(inputs)
        return th.where(self.is_diagonal, outputs.clamp(LOG_DIAGONAL_MIN, LOG_DIAGONAL_MAX).exp(), outputs)


class NAFPolicy(BasePolicy):
    """
    Policy class with a quadratic critic and its target network for NAF.

    :param observation_space: Observation space
    :param action_space: Action space
    :param lr_schedule: Learning rate schedule (could be constant)
    :param net_arch: Hidden layers, one list for all three heads (``[64, 64]`` by default)
        or one list each, ``dict(V=[...], mu=[...], L=[...])``
    :param activation_fn: Activation function (ReLU by default). Tanh suits smooth tasks of one step,
        but fails where values are large; with sigmoid, deeper networks hardly learn.
    :param features_extractor_class: Features extractor to use.
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
    :param lower_sees_action: Whether ``L`` also reads the action (False by default). ``Q`` is then no longer
        quadratic and can follow a cliff, while ``mu`` stays its maximum. For tasks of one step only:
        where the target bootstraps, learning suffers.
    """

    action_space: spaces.Box
    q_net: QuadraticCritic
    q_net_target: QuadraticCritic

    def __init__(
        self,
        observation_space: spaces.Space,
        action_space: spaces.Box,
        lr_schedule: Schedule,
        net_arch: list[int] | dict[str, list[int]] | None = None,
        activation_fn: type[nn.Module] = nn.ReLU,
        features_extractor_class: type[BaseFeaturesExtractor] = FlattenExtractor,
        features_extractor_kwargs: dict[str, Any] | None = None,
        normalize_images: bool = True,
        optimizer_class: type[th.optim.Optimizer] = th.optim.Adam,
        optimizer_kwargs: dict[str, Any] | None = None,
        squash_mu: bool = True,
        lower_sees_action: bool = False,
    ) -> None:
        if optimizer_kwargs is None and optimizer_class is th.optim.Adam:
            optimizer_kwargs = dict(fused=True)  # Several times faster on networks as small as these

        super().__init__(
            observation_space,
            action_space,
            features_extractor_class,
            features_extractor_kwargs,
            optimizer_class=optimizer_class,
            optimizer_kwargs=optimizer_kwargs,
            squash_output=True,
            normalize_images=normalize_images,
        )
        if net_arch is None:
            net_arch = [64, 64]
        if not isinstance(net_arch, dict):
            net_arch = dict.fromkeys(("V", "mu", "L"), net_arch)
        if set(net_arch) != {"V", "mu", "L"}:
            raise ValueError(f"net_arch must be a list or have the keys V, mu and L, not {sorted(net_arch)}")

        self.net_args: dict[str, Any] = {
            "observation_space": self.observation_space,
            "action_space": self.action_space,
            "net_arch": net_arch,
            "activation_fn": activation_fn,
            "normalize_images": normalize_images,
            "squash_mu": squash_mu,
            "lower_sees_action": lower_sees_action,
        }

        self._build(lr_schedule)

    def _build(self, lr_schedule: Schedule) -> None:
        """
        Create the networks and the optimizer.

        Put the target network into evaluation mode.

        :param lr_schedule: Learning rate schedule
            lr_schedule(1) is the initial learning rate
        """
        self.q_net = self.make_q_net()
        self.q_net_target = self.make_q_net()
        self.q_net_target.load_state_dict(self.q_net.state_dict())
        self.q_net_target.set_training_mode(False)

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
                net_arch=self.net_args["net_arch"],
                activation_fn=self.net_args["activation_fn"],
                squash_mu=self.net_args["squash_mu"],
                lower_sees_action=self.net_args["lower_sees_action"],
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
    Policy class for NAF when using images as input.

    :param observation_space: Observation space
    :param action_space: Action space
    :param lr_schedule: Learning rate schedule (could be constant)
    :param features_extractor_class: Features extractor to use.
    :param kwargs: Other arguments of :class:`NAFPolicy`
    """

    def __init__(
        self,
        observation_space: spaces.Space,
        action_space: spaces.Box,
        lr_schedule: Schedule,
        features_extractor_class: type[BaseFeaturesExtractor] = NatureCNN,
        **kwargs: Any,
    ) -> None:
        super().__init__(
            observation_space,
            action_space,
            lr_schedule,
            features_extractor_class=features_extractor_class,
            **kwargs,
        )


class MultiInputPolicy(NAFPolicy):
    """
    Policy class for NAF when using dict observations as input.

    :param observation_space: Observation space
    :param action_space: Action space
    :param lr_schedule: Learning rate schedule (could be constant)
    :param features_extractor_class: Features extractor to use.
    :param kwargs: Other arguments of :class:`NAFPolicy`
    """

    def __init__(
        self,
        observation_space: spaces.Dict,
        action_space: spaces.Box,
        lr_schedule: Schedule,
        features_extractor_class: type[BaseFeaturesExtractor] = CombinedExtractor,
        **kwargs: Any,
    ) -> None:
        super().__init__(
            observation_space,
            action_space,
            lr_schedule,
            features_extractor_class=features_extractor_class,
            **kwargs,
        )
