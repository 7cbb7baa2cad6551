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


def test_readme_names_every_command() -> None:
    commands = re.findall(r"^    (sarah-\w+) =", (ROOT / "setup.cfg").read_text(), re.MULTILINE)
    readme = (ROOT / "README.md").read_text()
    assert commands and [command for command in commands if f"    {command} " not in readme] == []
