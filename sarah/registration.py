"""Makes gymnasium know the environments by name, without importing gymnasium for those who do not use it."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from importlib.abc import MetaPathFinder
from importlib.machinery import ModuleSpec
from importlib.util import find_spec
from types import ModuleType

ENVIRONMENTS = {"SarahStepping-v0": "stepping", "SarahBalance-v0": "balance"}
"""Task of each registered environment."""


def register_environments() -> None:
    """Register the package's environments; importing ``sarah`` does so, as soon as gymnasium is imported too."""
    import gymnasium

    for name, task in ENVIRONMENTS.items():
        gymnasium.register(name, entry_point="sarah.envs:SarahEnv", kwargs={"task": task})


class _OnGymnasiumImport(MetaPathFinder):
    """Registers right after gymnasium's import, which takes longer than a command's ``--help`` may."""

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        if fullname != "gymnasium":
            return None
        sys.meta_path.remove(self)
        spec = find_spec(fullname)
        if spec is None or spec.loader is None:
            return spec
        execute = spec.loader.exec_module

        def execute_and_register(module: ModuleType) -> None:
            execute(module)
            register_environments()

        spec.loader.exec_module = execute_and_register  # type: ignore[method-assign]
        return spec


def register_with_gymnasium() -> None:
    """Register now if gymnasium is imported, otherwise when it will be."""
    if "gymnasium" in sys.modules:
        register_environments()
    else:
        sys.meta_path.insert(0, _OnGymnasiumImport())
