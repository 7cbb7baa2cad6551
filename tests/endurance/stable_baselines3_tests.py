"""stable-baselines3's own tests with NAF for TD3: ``python -m tests.endurance.stable_baselines3_tests``.

Takes the source of the installed version with pip, and runs every test of its that TD3 is a parameter of, as it stands.
Those that name inner parts of TD3 are left out.
"""

from __future__ import annotations

import subprocess
import sys
import tarfile
import tempfile
from importlib.metadata import version
from pathlib import Path

LEFT_OUT = {
    "test_cnn.py::test_features_extractor_target_net": "reads the actor's feature extractor",
    "test_custom_policy.py::test_custom_offpolicy[NAF-net_arch3]": "gives layers to the networks qf and pi",
    "test_run.py::test_offpolicy_multi_env": "sets n_critics",
    "test_save_load.py::test_save_load_policy": "reads policy.actor",
    "test_tensorboard.py::test_tensorboard[td3]": "looks for a log that is called TD3",
    "test_train_eval_mode.py::test_td3_train_with_batch_norm": "reads model.actor, and the two targets",
    "test_train_eval_mode.py::test_offpolicy_collect_rollout_batch_norm": "reads model.actor",
    "test_train_eval_mode.py::test_predict_with_dropout_batch_norm": "reads model.actor",
}
"""Tests that name parts of TD3 which NAF has not, by their names."""
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
        # Only the files that know TD3; others need packages that are of no use here.
        files = [file.name for file in sorted(tests.glob("test_*.py")) if "TD3" in file.read_text(encoding="utf-8")]
        left_out = [option for test in LEFT_OUT for option in ("--deselect", test)]
        plugin = ("-p", "naf_in_the_place_of_td3", "-p", "no:cacheprovider", "--rootdir", str(tests))
        command = [sys.executable, "-m", "pytest", "-q", *plugin, "-k", "NAF or td3", *left_out, *files]
        status = subprocess.run(command, cwd=tests).returncode
    for test, reason in LEFT_OUT.items():
        print(f"left out: {test}: {reason}")
    sys.exit(status)


if __name__ == "__main__":
    main()
