"""Hints for a name that an algorithm's settings lack: what they call it, and which algorithms have it."""

from __future__ import annotations

from dataclasses import fields
from difflib import get_close_matches

from sarah.errors import LONGEST_NAME, shortened
from sarah.runs.agent_settings import AGENT_SETTINGS, settings_of

ALIKE = (
    ("net_arch", "layers", "v_layers", "mu_layers", "l_layers"),
    ("activation_fn", "activation"),
    ("lr", "learning_rate"),
    ("action_noise", "action_noise_std", "exploration_std", "ent_coef"),
    ("sigma", "sigma0", "deviation"),
    ("popsize", "population"),
)
"""Names of what is alike: of stable-baselines3 and cma, and of the settings of this package."""


def unknown_option(algo: str, option: str) -> str | None:
    """Message about an option ``--agent.…`` that an algorithm has not; ``None`` if it has it.

    :param algo: name of the algorithm
    :param option: the option, without a value
    """
    name = option.removeprefix("--agent.").replace("-", "_").removeprefix("no_")
    own = [item.name for item in fields(settings_of(algo))]
    if name in own:
        return None
    others = [other for other, settings in AGENT_SETTINGS.items() if name in settings.__dataclass_fields__]
    wrong = f"{option} is for --algo {' or '.join(others)}, not {algo!r}"
    if not others:
        given = option if len(option) <= LONGEST_NAME else shortened(option)
        wrong = f"unknown option {given} of --algo {algo}"
    nearest = [meant for names in ALIKE if name in names for meant in own if meant in names]
    if not nearest and not others:
        nearest = get_close_matches(name, own, n=1)
    guess = f", did you mean {' or '.join(map(_option, nearest))}?" if nearest else ""
    return f"{wrong}{guess} (allowed: {', '.join(map(_option, own)) or 'none'})"


def _option(name: str) -> str:
    return f"--agent.{name.replace('_', '-')}"
