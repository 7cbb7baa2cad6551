"""Values of NAF: the networks V or W, mu and L."""

from functools import partial
from typing import Any, NamedTuple

import torch as th
from gymnasium import spaces
from stable_baselines3.common.policies import BaseModel
from stable_baselines3.common.preprocessing import get_action_dim
from stable_baselines3.common.torch_layers import BaseFeaturesExtractor, create_mlp
from stable_baselines3.common.type_aliases import PyTorchObs
from torch import nn

from sarah.agents.dropout import ByteDropout

LOG_DIAGONAL_MIN = -5.0
LOG_DIAGONAL_MAX = 5.0


class _InwardClamp(th.autograd.Function):
    """Logarithm of the diagonal of ``L``, clamped; beyond a bound it gets the gradients that lead back."""

    @staticmethod
    def forward(ctx: Any, outputs: th.Tensor) -> th.Tensor:
        ctx.save_for_backward(outputs)
        return outputs.clamp(LOG_DIAGONAL_MIN, LOG_DIAGONAL_MAX)

    @staticmethod
    def backward(ctx: Any, gradient: th.Tensor) -> th.Tensor:
        (outputs,) = ctx.saved_tensors
        leads_out = ((outputs > LOG_DIAGONAL_MAX) & (gradient < 0)) | ((outputs < LOG_DIAGONAL_MIN) & (gradient > 0))
        return gradient.masked_fill(leads_out, 0.0)


class Values(NamedTuple):
    """
    What a critic says of some states and actions, of shape (batch, 1) but for ``mu``.

    :param q: ``Q``, of the actions
    :param best: ``V``, of the best actions
    :param target: value of such a state in targets: ``W``, or ``V`` where there is no ``W``
    :param mu: Best actions, of shape (batch, action dim)
    :param distance: Squared distance of the actions from ``mu``
    """

    q: th.Tensor
    best: th.Tensor
    target: th.Tensor
    mu: th.Tensor
    distance: th.Tensor


class QuadraticCritic(BaseModel):
    r"""
    Action value that is quadratic in the action (Gu et al. 2016, https://arxiv.org/abs/1603.00748):

    .. math:: Q(s, u) = V(s) - \frac{1}{2} (u - \mu(s))^T (L(s) L(s)^T + c I) (u - \mu(s))

    with ``min_curvature`` as c, which is 0 in the publication.
    ``L`` is lower triangular with a positive diagonal, so ``L L^T`` is positive definite: ``mu`` is the best
    action and ``V`` its value, without a search. ``V`` is a network of its own on the features extractor: with layers
    of 64 units that all three shared, seeds of Pendulum failed. Actions are scaled to [-1, 1]. The output layer of
    ``mu`` starts at zero: an untrained critic proposes the centre of the action space whatever it observes.

    With layers for ``W`` in place of ``V``, three things are added to the publication here, and a pull of ``mu`` to the
    centre in the loss, see :func:`~sarah.agents.losses.centre_loss`. The first two are there because the parabola,
    which has many outputs, learns noise by heart, and that makes it steep:

    - Those layers have a second output: ``W``, the mean of what actions near ``mu`` led to. It has a loss of its own,
      and targets take it of the next state. ``V`` lies above the value of what was done, by what the parabola promises.
      Targets with ``V`` would add up these promises over the horizon.
    - Hidden layers of ``mu`` and ``L`` have dropout before their activation, as those of critics in DroQ (Hiraoka et
      al. 2022, https://arxiv.org/abs/2110.02034).
    - The first layer of ``V`` and ``W`` is normalised, as those of critics in RLPD (Ball et al. 2023,
      https://arxiv.org/abs/2302.02948). So what they say of states that nobody has seen is bounded.

    :param observation_space: Observation space
    :param action_space: Action space
    :param features_extractor: Network to extract features
        (a CNN when using images, a nn.Flatten() layer otherwise)
    :param features_dim: Number of features
    :param net_arch: Hidden layers by name: of each head, ``mu``, ``L`` and either ``V`` alone or ``W``, for ``V`` and
        ``W``, and ``shared``, which come before those of ``mu`` and ``L`` and serve both
    :param activation_fn: Activation function
    :param normalize_images: Whether to normalize images or not,
         dividing by 255.0 (True by default)
    :param squash_mu: Whether ``mu`` ends in a tanh; if not, it is linear and may leave [-1, 1]
    :param dropout: Share of the units that an update leaves out of each hidden layer of ``mu`` and ``L``; without
        effect where there is no ``W``
    :param min_curvature: Curvature that is added to that of ``L L^T``, see :class:`NAFPolicy`
    """

    action_space: spaces.Box
    features_extractor: BaseFeaturesExtractor
    rows: th.Tensor
    columns: th.Tensor
    on_diagonal: th.Tensor

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
        dropout: float = 0.2,
        min_curvature: float = 0.0,
    ) -> None:
        super().__init__(
            observation_space,
            action_space,
            features_extractor=features_extractor,
            normalize_images=normalize_images,
        )
        self.min_curvature = min_curvature
        self.has_w = "W" in net_arch

        action_dim = get_action_dim(action_space)
        rows, columns = th.tril_indices(action_dim, action_dim)
        # Row and column of each entry of L, one-hot: products with them are faster than filling a matrix
        self.register_buffer("rows", nn.functional.one_hot(rows, action_dim).T.float(), persistent=False)
        self.register_buffer("columns", nn.functional.one_hot(columns, action_dim).float(), persistent=False)
        self.register_buffer("on_diagonal", rows == columns, persistent=False)

        outputs, value_arch = (2, net_arch["W"]) if self.has_w else (1, net_arch["V"])
        value_layers = create_mlp(features_dim, outputs, value_arch, activation_fn)
        if self.has_w and value_arch:
            value_layers.insert(1, nn.LayerNorm(value_arch[0]))
        self.value_net = nn.Sequential(*value_layers)
        after: list[Any] = [lambda width: ByteDropout(dropout)] if self.has_w else []
        make_layers = partial(create_mlp, activation_fn=activation_fn, post_linear_modules=after)
        self.shared_net = nn.Sequential(*make_layers(features_dim, -1, net_arch["shared"]))
        shared_dim = [features_dim, *net_arch["shared"]][-1]
        self.mu_net = nn.Sequential(*make_layers(shared_dim, action_dim, net_arch["mu"], squash_output=squash_mu))
        self.lower_net = nn.Sequential(*make_layers(shared_dim, len(rows), net_arch["L"]))

        mu_output = [layer for layer in self.mu_net if isinstance(layer, nn.Linear)][-1]
        nn.init.zeros_(mu_output.weight)
        nn.init.zeros_(mu_output.bias)

    def forward(self, obs: PyTorchObs, actions: th.Tensor) -> th.Tensor:
        """
        Value of actions.

        :param obs: Observations
        :param actions: Actions, scaled to [-1, 1], of shape (batch, action dim)
        :return: ``Q`` of shape (batch, 1)
        """
        return self.all_values(obs, actions).q

    def all_values(self, obs: PyTorchObs, actions: th.Tensor) -> Values:
        """
        Values of actions, of the best ones, and those that targets take, in one pass.

        :param obs: Observations
        :param actions: Actions, scaled to [-1, 1], of shape (batch, action dim)
        :return: The values
        """
        features = self.extract_features(obs, self.features_extractor)
        shared = self.shared_net(features)
        mu = self.mu_net(shared)
        from_mu = actions - mu
        # (u - mu)^T L L^T (u - mu) is the squared length of the row (u - mu)^T L
        projected = (from_mu @ self.rows * self._entries(shared)) @ self.columns
        squared_length = (projected * projected).sum(dim=1, keepdim=True)
        distance = (from_mu * from_mu).sum(dim=1, keepdim=True)
        if self.min_curvature > 0:
            squared_length = squared_length + self.min_curvature * distance
        values = self.value_net(features)
        best_values = values[:, :1]
        return Values(best_values - 0.5 * squared_length, best_values, values[:, -1:], mu, distance)

    def value(self, obs: PyTorchObs) -> th.Tensor:
        """
        Value of the best action, the maximum of ``Q`` over the actions.

        :param obs: Observations
        :return: ``V`` of shape (batch, 1)
        """
        return self.value_net(self.extract_features(obs, self.features_extractor))[:, :1]

    def target_value(self, obs: PyTorchObs) -> th.Tensor:
        """
        Value that targets take of the next state.

        :param obs: Observations
        :return: ``W`` of shape (batch, 1), or ``V`` where there is no ``W``
        """
        return self.value_net(self.extract_features(obs, self.features_extractor))[:, -1:]

    def mu(self, obs: PyTorchObs) -> th.Tensor:
        """
        Best actions, where ``Q`` has its maximum.

        :param obs: Observations
        :return: ``mu`` of shape (batch, action dim), scaled so that the action space is [-1, 1]
        """
        return self.mu_net(self.shared_net(self.extract_features(obs, self.features_extractor)))

    def lower(self, obs: PyTorchObs) -> th.Tensor:
        """
        Matrix ``L``, filled row by row, its diagonal the exponential of a clamped output.

        :param obs: Observations
        :return: ``L`` of shape (batch, action dim, action dim)
        """
        entries = self._entries(self.shared_net(self.extract_features(obs, self.features_extractor)))
        return entries.unsqueeze(1) * self.rows @ self.columns

    def _entries(self, shared: th.Tensor) -> th.Tensor:
        outputs = self.lower_net(shared)
        return th.where(self.on_diagonal, _InwardClamp.apply(outputs).exp(), outputs)
