"""stable-baselines3's own tests with NAF in the place of TD3: ``python -m tests.endurance.stable_baselines3_tests``.

Takes the source of the installed version with pip, and runs every test of its that TD3 is a parameter of. The tests
that are about TD3's inner parts are listed below, with the reason, and left out; one trains longer.
"""

from __future__ import annotations

import subprocess
import sys
import tarfile
import tempfile
from importlib.metadata import version
from pathlib import Path

ABOUT_TD3 = {
    "test_custom_policy.py::test_custom_offpolicy[NAF-net_arch3]": "layers of TD3's actor and critic by their names",
    "test_cnn.py::test_features_extractor_target_net[True-NAF]": "TD3's actor, sharing its features with critics",
    "test_cnn.py::test_features_extractor_target_net[False-NAF]": "TD3's actor and its target",
    "test_run.py::test_offpolicy_multi_env[NAF]": "TD3's number of critics",
    "test_save_load.py::test_save_load_policy[False-MlpPolicy-NAF]": "saves TD3's actor alone",
    "test_save_load.py::test_save_load_policy[False-CnnPolicy-NAF]": "saves TD3's actor alone",
    "test_tensorboard.py::test_tensorboard[td3]": "a log folder with TD3's name",
    "test_train_eval_mode.py::test_td3_train_with_batch_norm": "statistics of TD3's actor",
    "test_train_eval_mode.py::test_offpolicy_collect_rollout_batch_norm[NAF]": "statistics of TD3's actor",
    "test_train_eval_mode.py::test_predict_with_dropout_batch_norm[Pendulum-v1-NAF]": "statistics of TD3's actor",
}
CHANGED = ("test_identity.py", "TD3: 400", "TD3: 1300", "NAF learns from step 1000 on, TD3 from step 100 on")
"""File, what stands there, what is put in its place, and why."""
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
        file, there, instead, reason = CHANGED
        text = (tests / file).read_text(encoding="utf-8")
        if text.count(there) != 1:
            raise SystemExit(f"{file} has other tests than those of the version that this was written for")
        (tests / file).write_text(text.replace(there, instead), encoding="utf-8")
        # Only the files that know TD3; others need packages that are of no use here.
        files = [file.name for file in sorted(tests.glob("test_*.py")) if "TD3" in file.read_text(encoding="utf-8")]
        left_out = [option for test in ABOUT_TD3 for option in ("--deselect", test)]
        plugin = ("-p", "naf_in_the_place_of_td3", "-p", "no:cacheprovider", "--rootdir", str(tests))
        command = [sys.executable, "-m", "pytest", "-q", *plugin, "-k", "NAF or td3", *left_out, *files]
        status = subprocess.run(command, cwd=tests).returncode
    print(f"changed: {file}: {there} to {instead}: {reason}")
    for test, reason in ABOUT_TD3.items():
        print(f"left out: {test}: {reason}")
    sys.exit(status)


if __name__ == "__main__":
    main()
