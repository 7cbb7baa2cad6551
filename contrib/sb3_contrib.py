"""NAF as a pull request to sb3-contrib: ``python -m contrib.sb3_contrib CLONE`` puts it into a clone of that.

The algorithm and its tests are those of ``agents/`` and ``tests/agents/``, without what stays ours: LocalNAF, its
presets, and replay by ranks. sb3-contrib wants an issue before a pull request, and to be told where a code assistant
helped.
"""

from __future__ import annotations

import ast
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

from experiments import record
from experiments.naf.mujoco_tasks import four_algorithms
from experiments.record import ROOT
from sarah.errors import ConfigurationError

MODULES = ("naf", "policies", "critic", "losses", "dropout", "arguments", "naf_warnings", "unknown_arguments")
EXPORTS = ("NAF", "CnnPolicy", "MlpPolicy", "MultiInputPolicy")
OURS = {"LocalNAF", "PRESETS", "RankReplayBuffer", "checked_disturbances"}
"""Names that stay here."""
NOT_THERE = ("hypothesis", "sarah.agents.buffers")
"""Modules that sb3-contrib does not have."""
TESTS = "test_naf_*.py"
INSERTED = {
    "sb3_contrib/__init__.py": {
        "from sb3_contrib.ppo_mask": "from sb3_contrib.naf import NAF\n",
        '    "QRDQN",': '    "NAF",\n',
    },
    "docs/index.rst": {"  modules/ppo_mask": "  modules/naf\n"},
    "docs/guide/algos.md": {
        "| QR-DQN ": "| NAF          | ✔️    | ❌         | ❌              | ❌            | ✔️               |\n"
    },
    "docs/misc/changelog.md": {
        "### Bug Fixes:": "- Added `NAF`, Q-learning with normalized advantage functions, without an actor\n\n"
    },
    "README.md": {
        "- [PPO with invalid": "- [Normalized Advantage Functions (NAF)](https://arxiv.org/abs/1603.00748)\n",
    },
}
"""Lines by file and by the beginning of the line before which they go."""


def without_ours(source: str) -> str:
    """Source code without definitions, tests and conditions that name what stays here.

    :param source: text of a module
    """
    lines = source.splitlines(keepends=True)
    for node in _left_out(ast.parse(source)):
        first = min(one.lineno for one in (node, *getattr(node, "decorator_list", ())))
        lines[first - 1 : node.end_lineno] = [""] * ((node.end_lineno or first) - first + 1)
    return "".join(lines)


def _left_out(tree: ast.Module) -> Iterator[ast.stmt]:
    """Statements that go: conditions of methods, and whatever a module has outside its classes."""
    names: set[str] = set()  # defined by what has gone
    for node in tree.body:
        if isinstance(node, ast.ImportFrom):
            if node.module in NOT_THERE:
                names |= {alias.asname or alias.name for alias in node.names}
                yield node
        elif isinstance(node, ast.ClassDef):
            yield from (one for one in ast.walk(node) if isinstance(one, ast.If) and _is_ours(one, names))
        elif _is_ours(node, names):
            names |= {node.name} if isinstance(node, ast.FunctionDef) else set()
            names |= (
                {one.id for one in node.targets if isinstance(one, ast.Name)} if isinstance(node, ast.Assign) else set()
            )
            yield node


def _is_ours(node: ast.AST, names: set[str]) -> bool:
    """Whether it names what stays here, also in a text, or something else that goes."""
    for one in ast.walk(node):
        if isinstance(one, ast.Constant) and isinstance(one.value, str) and any(name in one.value for name in OURS):
            return True
        name = one.id if isinstance(one, ast.Name) else one.name if isinstance(one, ast.FunctionDef) else ""
        if name in OURS | names:
            return True
    return False


def write(folder: Path) -> list[Path]:
    """Write the new files: the algorithm, its tests and its page.

    :param folder: clone of sb3-contrib, or an empty folder
    :return: the files
    """
    package, tests, page = folder / "sb3_contrib" / "naf", folder / "tests", folder / "docs" / "modules" / "naf.md"
    for place in (package, tests, page.parent):
        place.mkdir(parents=True, exist_ok=True)
    sources = {package / f"{name}.py": ROOT / "agents" / f"{name}.py" for name in MODULES}
    sources |= {tests / path.name: path for path in sorted((ROOT / "tests" / "agents").glob(TESTS))}
    for path, source in sources.items():
        text = without_ours(source.read_text(encoding="utf-8"))
        path.write_text(text.replace("sarah.agents", "sb3_contrib.naf"), encoding="utf-8")
    exports = "\n".join(f'    "{name}",' for name in EXPORTS)
    (package / "__init__.py").write_text(
        "from sb3_contrib.naf.naf import NAF\n"
        "from sb3_contrib.naf.policies import CnnPolicy, MlpPolicy, MultiInputPolicy\n\n"
        f"__all__ = [\n{exports}\n]\n",
        encoding="utf-8",
    )
    made = "mujoco_tasks" in record.names()
    results = four_algorithms(record.read("mujoco_tasks").table) if made else "*Still to be made.*"
    template = Path(__file__).with_name("naf.md").read_text(encoding="utf-8")
    page.write_text(template.replace("{results}", results), encoding="utf-8")
    code = [*sources, package / "__init__.py"]
    style = ("--quiet", "--isolated", "--line-length", "127")
    for command in (("check", "--fix-only", "--select", "F401,I"), ("format",)):
        subprocess.run([sys.executable, "-m", "ruff", *command, *style, *map(str, code)], check=True)
    return [*code, page]


def insert(folder: Path) -> None:
    """Name NAF where sb3-contrib lists its algorithms, once.

    :param folder: clone of sb3-contrib
    :raises ConfigurationError: if a file has no such line
    """
    changed: dict[Path, str] = {}
    for name, lines in INSERTED.items():
        path = folder / name
        if not path.exists():
            raise ConfigurationError(f"{folder} is no clone of sb3-contrib: it has no {name}")
        text = path.read_text(encoding="utf-8")
        for before, line in lines.items():
            start = text.find(f"\n{before}") + 1
            if not start:
                raise ConfigurationError(f"no line of {path} begins with {before!r}")
            if line.rstrip() not in text:
                text = text[:start] + line + text[start:]
        changed[path] = text
    for path, text in changed.items():
        path.write_text(text, encoding="utf-8")


def main(arguments: list[str]) -> None:
    """Put NAF into a clone."""
    if len(arguments) != 1:
        raise ConfigurationError("python -m contrib.sb3_contrib CLONE: the folder of a clone of sb3-contrib")
    insert(Path(arguments[0]))
    for path in write(Path(arguments[0])):
        print(path)


if __name__ == "__main__":
    from sarah.cli.options import as_command

    with as_command("contrib.sb3_contrib"):
        main(sys.argv[1:])
