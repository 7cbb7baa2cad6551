"""Messages for arguments that NAF does not have: the nearest name, or why there is none."""

from collections.abc import Callable
from difflib import get_close_matches
from functools import wraps
from inspect import signature
from typing import ParamSpec

P = ParamSpec("P")

ONE_ACTION = "targets take W or V of the next state, and neither needs an action to smooth"
NO_ENTROPY = "mu is one action and has no entropy, and exploration_std sets how widely it explores"
GAUSSIAN = "exploration is Gaussian noise, and exploration_std sets its width, by a number or a schedule"
OF_POLICY = "it goes into policy_kwargs"
WHY_NOT = {
    "policy_delay": "there is no actor to delay, as mu is part of Q",
    "target_policy_noise": ONE_ACTION,
    "target_noise_clip": ONE_ACTION,
    "n_critics": "targets take W, a mean, so no second critic has to lower a maximum",
    "ent_coef": NO_ENTROPY,
    "target_entropy": NO_ENTROPY,
    "exploration_fraction": GAUSSIAN,
    "exploration_initial_eps": GAUSSIAN,
    "exploration_final_eps": GAUSSIAN,
    **dict.fromkeys(("use_sde", "sde_sample_freq", "use_sde_at_warmup"), GAUSSIAN),
    "share_features_extractor": "V, W, mu and L share one, and the target network has its own",
    "target_update_interval": "the target network follows in every update, by tau",
    **dict.fromkeys(("net_arch", "activation_fn", "dropout", "squash_mu", "min_curvature"), OF_POLICY),
    **dict.fromkeys(("features_extractor_class", "features_extractor_kwargs", "normalize_images"), OF_POLICY),
    **dict.fromkeys(("optimizer_class", "optimizer_kwargs"), OF_POLICY),
}
"""Reason why NAF has no such argument, by the name that it has elsewhere."""
WHY_NOT |= dict.fromkeys(("elite_share", "elite_std", "elite_draws", "first_action_centre"), "only LocalNAF has it")


def explains_unknown(init: Callable[P, None]) -> Callable[P, None]:
    """
    Decorator for a constructor: its ``TypeError`` for an unknown argument says what to write instead.

    :param init: Constructor
    :return: The constructor
    """
    own = signature(init).parameters

    @wraps(init)
    def explaining(*arguments: P.args, **named: P.kwargs) -> None:
        unknown = next((name for name in named if name not in own), None)
        if unknown is not None:
            known = [name for name in list(own)[len(arguments) :] if not name.startswith("_")]
            advice = _advice(unknown, known)
            raise TypeError(f"{type(arguments[0]).__name__}.__init__() got an unexpected keyword argument {advice}")
        init(*arguments, **named)

    return explaining


def _advice(unknown: str, known: list[str]) -> str:
    """The unknown name, and what to write instead."""
    if unknown in WHY_NOT:
        return f"{unknown!r}: {WHY_NOT[unknown]}"
    if nearest := get_close_matches(unknown.lower(), known, n=1):
        return f"{unknown!r}, did you mean {nearest[0]!r}?"
    return f"{unknown!r}, allowed are {', '.join(known)}"
