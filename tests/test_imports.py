"""Importing the package: what it does to Python, and which part of it imports which."""

import subprocess
import sys
from pathlib import Path

import pytest

import sarah

ROOT = Path(__file__).parent.parent


def test_importing_registers_environments_and_patches_nothing() -> None:
    program = (
        "import sys\n"
        "before = list(sys.meta_path), list(sys.path_hooks), sys.excepthook, __import__\n"
        "import sarah\n"
        "assert before == (list(sys.meta_path), list(sys.path_hooks), sys.excepthook, __import__)\n"
        "import gymnasium\n"
        "print(*sorted(name for name in gymnasium.registry if name.startswith('Sarah')))\n"
        "print(*sorted({'mujoco', 'pybullet', 'torch', 'stable_baselines3', 'matplotlib'} & set(sys.modules)))\n"
    )
    process = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert process.stdout.splitlines() == ["SarahBalance-v0 SarahEpisode-v0 SarahOperation-v0 SarahStepping-v0", ""]


def test_a_command_imports_nothing_slow_that_its_episodes_do_not_need() -> None:
    """Importing yourdfpy, which brings scipy, takes longer than the episode; the robot is the default one."""
    program = (
        "import sys\n"
        "from sarah.cli.eval import main\n"
        "sys.argv = ['sarah-eval', 'stepping', '--episodes', '1', '--episode.time-limit', '2']\n"
        "main()\n"
        "slow = {'yourdfpy', 'scipy', 'torch', 'stable_baselines3', 'matplotlib', 'pandas', 'sklearn', 'distributed'}\n"
        "sys.exit(' '.join(slow & set(sys.modules)) or 0)"
    )
    process = subprocess.run([sys.executable, "-c", program], cwd=ROOT, capture_output=True, text=True)
    assert process.returncode == 0, process.stderr


@pytest.mark.parametrize("package", sorted(path.parent.name for path in (ROOT / "sarah").glob("*/__init__.py")))
def test_every_package_says_what_it_is_for(package: str) -> None:
    text = (ROOT / "sarah" / package / "__init__.py").read_text(encoding="utf-8")
    assert text.startswith('"""') and len(text.split('"""')[1]) > 30


def test_no_module_imports_the_package_that_imports_it() -> None:
    grimp = pytest.importorskip("grimp", reason="import-linter is not installed")
    graph = grimp.build_graph("experiments", "sarah", cache_dir=None)
    circles = [
        (module, package)
        for module in graph.modules
        for package in graph.find_modules_directly_imported_by(module)
        if module.startswith(f"{package}.") and graph.chain_exists(importer=package, imported=module)
    ]
    assert circles == []


def test_a_shell_completes_the_public_names() -> None:
    assert set(sarah.__all__) <= set(dir(sarah))
    with pytest.raises(AttributeError, match="simulat"):
        sarah.simulat  # noqa: B018
