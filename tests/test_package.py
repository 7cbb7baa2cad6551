"""The package: what importing it does to Python, which part imports which, and what is built of it."""

import json
import os
import shutil
import subprocess
import sys
import tarfile
import zipfile
from pathlib import Path
from typing import Any

import pytest

import sarah
from sarah.versions import source_hash

ROOT = Path(__file__).parent.parent


def test_importing_registers_environments_and_patches_nothing() -> None:
    program = """
import sys
before = list(sys.meta_path), list(sys.path_hooks), sys.excepthook, __import__
import sarah
assert before == (list(sys.meta_path), list(sys.path_hooks), sys.excepthook, __import__)
import gymnasium
print(*sorted(name for name in gymnasium.registry if name.startswith('Sarah')))
"""
    process = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert process.stdout.split() == ["SarahBalance-v0", "SarahEpisode-v0", "SarahOperation-v0", "SarahStepping-v0"]


COMMAND = "import sys\nfrom sarah.cli.{0} import main\nsys.argv = 'sarah-{0} {1}'.split()\nmain()"
SLOW = {
    "import sarah": "mujoco pybullet torch stable_baselines3 matplotlib sarah.episode.shipped",
    # Importing yourdfpy, which brings scipy, takes longer than the episode; the robot is the default one
    COMMAND.format("eval", "stepping --episodes 1 --episode.time-limit 2"): (
        "yourdfpy scipy torch stable_baselines3 matplotlib pandas sklearn distributed"
    ),
    COMMAND.format("describe", ""): "pybullet mujoco torch",
}


@pytest.mark.parametrize("program", SLOW)
def test_nothing_slow_is_loaded_without_need(program: str, tmp_path: Path) -> None:
    check = f"{program}\nimport sys\nsys.exit(' '.join({set(SLOW[program].split())} & set(sys.modules)) or 0)"
    process = subprocess.run([sys.executable, "-c", check], cwd=tmp_path, capture_output=True, text=True)
    assert process.returncode == 0, process.stderr
    assert "describe" not in program or (tmp_path / "sarah_robot.png").stat().st_size > 50_000


def test_no_module_imports_the_package_that_imports_it() -> None:
    grimp = pytest.importorskip("grimp", reason="import-linter is not installed")
    graph = grimp.build_graph("experiments", "sarah", cache_dir=None)
    for module in graph.modules:
        for package in graph.find_modules_directly_imported_by(module):
            is_above = module.startswith(f"{package}.")
            assert not (is_above and graph.chain_exists(importer=package, imported=module)), (module, package)


def test_a_shell_completes_the_public_names() -> None:
    assert set(sarah.__all__) <= set(dir(sarah))
    with pytest.raises(AttributeError, match="simulat"):
        sarah.simulat  # noqa: B018


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
    data = {"sarah/urdf/sarah.urdf.xacro", "sarah/py.typed", "sarah/episode/parameter_sets.json"}
    data |= {"sarah/remote/request.schema.json"}
    assert data | {"sarah/urdf/__init__.py", "sarah/agents/local_naf.py"} <= set(names)
    assert sorted(names) == sorted(set(names))
    modules = {str(path.relative_to(ROOT)) for path in (ROOT / "sarah").rglob("*.py")}
    assert modules <= set(names), "setup.cfg lists every package"
    tops = {name.split("/")[0] for name in names}
    assert {top for top in tops if not top.endswith(".dist-info")} == {"sarah"}


def test_sdist_holds_what_a_developer_needs(built: tuple[Path, Path]) -> None:
    with tarfile.open(built[0]) as archive:
        names = {name.split("/", 1)[1] for name in archive.getnames() if "/" in name}
    assert {"setup.cfg", "pyproject.toml", "constraints.txt", "Makefile", "LICENSE", "urdf/sarah.urdf.xacro"} <= names
    assert {"agents/naf.py", "tests/test_package.py", "README.md", "CITATION.cff", "CHANGELOG.md"} <= names


def test_wheel_works_from_another_folder(built: tuple[Path, Path], tmp_path: Path) -> None:
    site = tmp_path / "site"
    pip = [sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--target", str(site), str(built[1])]
    subprocess.run(pip, check=True, capture_output=True)
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    there: dict[str, Any] = {"cwd": elsewhere, "env": {**os.environ, "PYTHONPATH": str(site)}, "capture_output": True}
    process = subprocess.run([sys.executable, "-c", PROGRAM], **there, text=True, check=True)
    assert process.stdout.startswith(str(site))
    assert source_hash() in process.stdout  # workers may have the wheel, and the learner a checkout
    assert "0.84" in process.stdout and "one-step" in process.stdout
    arguments = ["0.4,1.3,0.1,1,1", "--episodes", "1", "--episode.time-limit", "2", "--json"]
    evaluated = subprocess.run([site / "bin" / "sarah-eval", *arguments], **there, check=True)
    assert json.loads(evaluated.stdout)["survival_rate"] == 1.0
