"""What is built: the wheel and the sdist hold everything, and claim one name."""

import json
import os
import shutil
import subprocess
import sys
import tarfile
import zipfile
from pathlib import Path

import pytest

from sarah.versions import source_hash

ROOT = Path(__file__).parent.parent
PROGRAM = (
    "import sarah, sarah.agents, sarah.urdf\n"
    "from sarah.robot.description import describe_robot\n"
    "from sarah.versions import source_hash\n"
    "print(sarah.__file__, source_hash(), describe_robot().standing_height, sorted(sarah.agents.PRESETS))"
)


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """An sdist of the checkout, and the wheel made from that sdist; built in a copy, without what others built."""
    copy, folder = tmp_path_factory.mktemp("copy") / "sarah", tmp_path_factory.mktemp("dist")
    everywhere = shutil.ignore_patterns(".git", ".venv*", ".*_cache", ".hypothesis", "*.egg-info", "build", "dist")

    def left_out(folder: str, names: list[str]) -> set[str]:
        return everywhere(folder, names) | ({"runs"} if Path(folder) == ROOT else set())

    shutil.copytree(ROOT, copy, symlinks=True, ignore=left_out)
    command = [sys.executable, "-m", "build", "--no-isolation", "--outdir", str(folder), str(copy)]
    subprocess.run(command, check=True, capture_output=True)
    (sdist,), (wheel,) = folder.glob("*.tar.gz"), folder.glob("*.whl")
    return sdist, wheel


def test_wheel_holds_the_robot_and_the_agent_and_claims_one_name(built: tuple[Path, Path]) -> None:
    names = zipfile.ZipFile(built[1]).namelist()
    for name in (
        "urdf/sarah.urdf.xacro",
        "urdf/__init__.py",
        "agents/local_naf.py",
        "cli/train.py",
        "py.typed",
        "episode/parameter_sets.json",
    ):
        assert f"sarah/{name}" in names
    assert sorted(names) == sorted(set(names))
    modules = {str(path.relative_to(ROOT)) for path in (ROOT / "sarah").rglob("*.py")}
    assert modules <= set(names), "setup.cfg lists every package"
    tops = {name.split("/")[0] for name in names}
    assert {top for top in tops if not top.endswith(".dist-info")} == {"sarah"}


def test_sdist_holds_what_a_developer_needs(built: tuple[Path, Path]) -> None:
    with tarfile.open(built[0]) as archive:
        names = {name.split("/", 1)[1] for name in archive.getnames() if "/" in name}
    for name in ("setup.cfg", "pyproject.toml", "constraints.txt", "Makefile", "LICENSE", "urdf/sarah.urdf.xacro"):
        assert name in names
    assert {"agents/naf.py", "tests/test_package.py", "README.md", "CITATION.cff", "CHANGELOG.md"} <= names


def test_wheel_works_from_another_folder(built: tuple[Path, Path], tmp_path: Path) -> None:
    site = tmp_path / "site"
    pip = [sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--target", str(site), str(built[1])]
    subprocess.run(pip, check=True, capture_output=True)
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    environment = {**os.environ, "PYTHONPATH": str(site)}
    process = subprocess.run(
        [sys.executable, "-c", PROGRAM], cwd=elsewhere, env=environment, capture_output=True, text=True, check=True
    )
    assert process.stdout.startswith(str(site))
    assert source_hash() in process.stdout  # workers may have the wheel, and the learner a checkout
    assert "0.84" in process.stdout and "one-step" in process.stdout
    arguments = ["0.4,1.3,0.1,1,1", "--episodes", "1", "--episode.time-limit", "2", "--json"]
    evaluated = subprocess.run(
        [site / "bin" / "sarah-eval", *arguments], cwd=elsewhere, env=environment, capture_output=True, check=True
    )
    assert json.loads(evaluated.stdout)["survival_rate"] == 1.0
