"""What the site's own build cannot see; `make docs` sees the rest."""

import re
from dataclasses import replace
from importlib import import_module
from pathlib import Path

import pytest

from sarah.episode.episode import simulate
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import TASKS

ROOT = Path(__file__).parent.parent


@pytest.mark.parametrize("page", ["README.md", "CONTRIBUTING.md", "runs/README.md"])
def test_links_lead_to_files(page: str) -> None:
    path = ROOT / page
    links = [link for link in re.findall(r"\]\(([^)#\s]+)", path.read_text()) if not link.startswith("http")]
    missing = [link for link in links if not (path.parent / link).exists()]
    assert not missing


def test_tutorials_and_guides_show_every_command() -> None:
    commands = re.findall(r"^    (sarah-\w+) =", (ROOT / "setup.cfg").read_text(), re.MULTILINE)
    pages = [*ROOT.glob("docs/tutorials/*.md"), *ROOT.glob("docs/how_to/*.md")]
    shown = "\n".join(page.read_text() for page in pages)
    assert commands and [command for command in commands if f"\n    {command} " not in shown] == []


def test_contributing_answers_with_one_file_each() -> None:
    section = (ROOT / "CONTRIBUTING.md").read_text().split("## Where do I change")[1].split("\n## ")[0]
    files = re.findall(r"^\| (.+?) \| `([^`]+)`", section, re.MULTILINE)
    assert len(files) >= 5 and [file for _, file in files if not (ROOT / file).is_file()] == []


def test_the_task_of_the_tutorial_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    blocks = re.findall(r"```python\n(.*?)```", (ROOT / "docs/tutorials/own_task.md").read_text(), re.DOTALL)
    (tmp_path / "together.py").write_text(blocks[0])
    monkeypatch.syspath_prepend(tmp_path)
    task = import_module("together").TOGETHER
    monkeypatch.setitem(TASKS, task.name, task)
    config = replace(task.episode, time_limit=1.5)
    assert simulate(EpisodeSpec(task.baseline, 0, task.name, config)).survived
