"""Names of the environments in gymnasium."""

from __future__ import annotations

import gymnasium

ENVIRONMENTS = {
    "SarahStepping-v0": {"task": "stepping"},
    "SarahBalance-v0": {"task": "balance"},
    "SarahEpisode-v0": {},
}
"""Keywords of each registered environment of episodes, by its name; ``SarahEpisode-v0`` is given its task."""
OPERATION = "SarahOperation-v0"
"""Name of the environment of a robot in operation."""


def register_environments() -> None:
    """Register the package's environments, which ``import sarah`` does."""
    for name, keywords in ENVIRONMENTS.items():
        gymnasium.register(name, entry_point="sarah.envs.sarah_env:SarahEnv", kwargs=keywords)
    gymnasium.register(OPERATION, entry_point="sarah.envs.operation_env:SarahOperationEnv")
