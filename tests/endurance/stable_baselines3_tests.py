"""stable-baselines3's own tests with NAF in the place of TD3: ``python -m tests.endurance.stable_baselines3_tests``.

Takes the source of the installed version with pip, and runs every test of its that TD3 is a parameter of. Where a test
names parts of TD3, the parts of NAF are put in their place. One is about a part that NAF has not, and is left out.
"""

from __future__ import annotations

import subprocess
import sys
import tarfile
import tempfile
from importlib.metadata import version
from pathlib import Path
from typing import NamedTuple

LEFT_OUT = {
    "test_cnn.py::test_features_extractor_target_net[True-NAF]": "TD3's actor shares its features; NAF has no actor",
}


class Change(NamedTuple):
    """A change to a file of tests.

    :param file: name of the file
    :param there: text that stands there, once or more often
    :param instead: text that is put in its place
    :param reason: reason for the change
    """

    file: str
    there: str
    instead: str
    reason: str


CNN, MODES = "test_cnn.py", "test_train_eval_mode.py"
NETWORKS = "NAF's networks are q_net and its target, as DQN's"
CHANGES = (
    Change("test_custom_policy.py", "dict(qf=[8], pi=[8, 4])", "dict(V=[8], mu=[8, 4], L=[8])", "names of networks"),
    Change("test_run.py", "dict(net_arch=[64], n_critics=1)", "dict(net_arch=[64])", "NAF has one critic"),
    Change(
        "test_save_load.py", "if model_class in [SAC, TD3]:\n        actor =", "if False:\n        actor =", "no actor"
    ),
    Change(
        "test_tensorboard.py",
        "logname = model_name.upper()",
        "logname = MODEL_DICT[model_name][0].__name__",
        "name of the algorithm",
    ),
    Change(CNN, "isinstance(model, DQN)", "isinstance(model, (DQN, TD3))", NETWORKS),
    Change(CNN, "model_class == TD3", "False", NETWORKS),
    Change(CNN, "model_class != DQN", "model_class == SAC", NETWORKS),
    Change(
        CNN, 'else:\n        kwargs["target', 'elif model_class == DQN:\n        kwargs["target', "the target follows"
    ),
    *(
        Change(MODES, f"model.{theirs}.features", f"model.{ours}.features", NETWORKS)
        for theirs, ours in (
            ("actor", "q_net"),
            ("critic", "q_net"),
            ("actor_target", "q_net_target"),
            ("critic_target", "q_net_target"),
        )
    ),
)
PLUGIN = "import stable_baselines3\nfrom sarah.agents import NAF\nstable_baselines3.TD3 = NAF\n"


def main() -> None:
    """Run them, and say what is left out."""
    with tempfile.TemporaryDirectory() as folder:
        name = "stable_baselines3"
        arguments = ("--quiet", "--no-deps", "--no-binary", name, "--dest", folder, f"{name}=={version(name)}")
        subprocess.run([sys.executable, "-m", "pip", "download", *arguments], check=True)
        (archive,) = Path(folder).glob("*.tar.gz")
        with tarfile.open(archive) as source:
            source.extractall(folder, filter="data")
        (tests,) = Path(folder).glob("*/tests")
        (tests / "naf_in_the_place_of_td3.py").write_text(PLUGIN, encoding="utf-8")
        for change in CHANGES:
            text = (tests / change.file).read_text(encoding="utf-8")
            if change.there not in text:
                raise SystemExit(f"{change.file} has other tests than those of the version that this was written for")
            (tests / change.file).write_text(text.replace(change.there, change.instead), encoding="utf-8")
        # Only the files that know TD3; others need packages that are of no use here.
        files = [file.name for file in sorted(tests.glob("test_*.py")) if "TD3" in file.read_text(encoding="utf-8")]
        left_out = [option for test in LEFT_OUT for option in ("--deselect", test)]
        plugin = ("-p", "naf_in_the_place_of_td3", "-p", "no:cacheprovider", "--rootdir", str(tests))
        command = [sys.executable, "-m", "pytest", "-q", *plugin, "-k", "NAF or td3", *left_out, *files]
        status = subprocess.run(command, cwd=tests).returncode
    for change in CHANGES:
        print(f"changed: {change.file}: {change.there!r} to {change.instead!r}: {change.reason}")
    for test, reason in LEFT_OUT.items():
        print(f"left out: {test}: {reason}")
    sys.exit(status)


if __name__ == "__main__":
    main()
