"""Names of the environments in gymnasium."""

from __future__ import annotations

import gymnasium

ENVIRONMENTS = {
    "SarahStepping-v0": {"task": "stepping"},
    "SarahBalance-v0": {"task": "balance"},
    "SarahEpisode-v0": {},
}
"""Keywords of each registered environment, by its name; ``SarahEpisode-v0`` is given its task."""


def register_environments() -> None:
    """Register the package's environments, which ``import sarah`` does."""
    for name, keywords in ENVIRONMENTS.items():
        gymnasium.register(name, entry_point="sarah.envs.sarah_env:SarahEnv", kwargs=keywords)
