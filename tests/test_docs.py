"""What the site's own build cannot see; `make docs` sees the rest."""

import re
from pathlib import Path

import pytest

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
