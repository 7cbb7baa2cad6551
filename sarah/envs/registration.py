"""Names of the environments in gymnasium."""

from __future__ import annotations

import gymnasium

ENVIRONMENTS = {"SarahStepping-v0": "stepping", "SarahBalance-v0": "balance"}
"""Task of each registered environment, by the environment's name."""


def register_environments() -> None:
    """Register the package's environments, which ``import sarah`` does."""
    for name, task in ENVIRONMENTS.items():
        gymnasium.register(name, entry_point="sarah.envs.sarah_env:SarahEnv", kwargs={"task": task})
