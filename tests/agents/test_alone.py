"""NAF needs stable-baselines3 and what that needs, but nothing else that sarah installs."""

import subprocess
import sys
from importlib.metadata import Distribution, distributions, requires

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

PROGRAM = """
import sys

class Finder:
    finders = sys.meta_path[:]

    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in {absent}:
            return None
        return next(filter(None, (finder.find_spec(name, path, target) for finder in self.finders)), None)

sys.meta_path[:] = [Finder()]
from sarah.agents import NAF, LocalNAF
for algorithm in (NAF, LocalNAF):
    model = algorithm("MlpPolicy", "Pendulum-v1", learning_starts=10, policy_kwargs=dict(net_arch=[8])).learn(20)
    model.save({file!r})
    algorithm.load({file!r}).predict(model.observation_space.sample())
"""


def needed(name: str) -> set[str]:
    """Distributions that one needs, with itself."""
    own = [Requirement(line) for line in requires(name) or []]
    here = [one.name for one in own if one.marker is None or one.marker.evaluate({"extra": ""})]
    return {canonicalize_name(name)}.union(*map(needed, here))


def modules(of: list[Distribution]) -> set[str]:
    """Modules of distributions, by what they install: not all of them say."""
    return {file.parts[0].partition(".")[0] for one in of for file in one.files or ()}


def test_naf_needs_only_stable_baselines3(tmp_path):
    own = needed("stable-baselines3") | {"sarah"}
    here = {canonicalize_name(one.metadata["Name"]): one for one in distributions()}
    absent = modules([here[name] for name in here.keys() - own]) - modules([here[name] for name in here.keys() & own])
    assert {"scipy", "sklearn", "yaml", "tyro"} <= absent and not {"torch", "gymnasium"} & absent
    program = PROGRAM.format(absent=absent, file=str(tmp_path / "agent"))
    process = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert process.returncode == 0, process.stderr
