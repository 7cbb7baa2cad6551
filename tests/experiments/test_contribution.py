"""NAF as a pull request to sb3-contrib."""

import re
import sys
from pathlib import Path

import pytest
from pytest import MonkeyPatch

from contrib.sb3_contrib import INSERTED, insert, main, without_ours, write
from sarah.errors import ConfigurationError


def clone(folder: Path) -> Path:
    """The lines of sb3-contrib's files that NAF's go before."""
    for name, lines in INSERTED.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("\n" + "".join(f"{before}\n" for before in lines), encoding="utf-8")
    return folder


def test_naf_learns_and_loads_as_a_module_of_sb3_contrib(tmp_path: Path, monkeypatch: MonkeyPatch) -> None:
    write(tmp_path)
    (tmp_path / "sb3_contrib" / "__init__.py").touch()
    for name in [name for name in sys.modules if name.startswith("sb3_contrib")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.syspath_prepend(tmp_path)
    from sb3_contrib.naf import NAF  # type: ignore[import-not-found]

    model = NAF("MlpPolicy", "Pendulum-v1", learning_starts=10, policy_kwargs={"net_arch": [8]}).learn(20)
    model.save(tmp_path / "naf")
    assert type(NAF.load(tmp_path / "naf")).__module__ == "sb3_contrib.naf.naf"
    with pytest.raises(TypeError, match=r"'elite_share', allowed are"):
        NAF("MlpPolicy", "Pendulum-v1", elite_share=0.5)
    for name in [name for name in sys.modules if name.startswith("sb3_contrib")]:
        del sys.modules[name]


def test_what_stays_ours_is_named_nowhere(tmp_path: Path) -> None:
    for path in write(tmp_path):
        text = path.read_text(encoding="utf-8")
        assert not re.findall(r"sarah|LocalNAF|PRESETS|RankReplay|elite|\{results\}", text), path
        compile(text if path.suffix == ".py" else "", str(path), "exec")


def test_what_names_ours_goes_with_what_it_needs() -> None:
    source = (
        "from sarah.agents.buffers import RankReplayBuffer\n"
        "RANKED = dict(replay_buffer_class=RankReplayBuffer)\n"
        "def test_ranks():\n    assert RANKED\n"
        "class NAF:\n    def setup(self):\n"
        "        if isinstance(self, RankReplayBuffer):\n            raise ValueError\n"
        "        self.ready = True\n"
        "def test_naf():\n    assert NAF\n"
    )
    kept = "class NAF:\n    def setup(self):\n        self.ready = True\ndef test_naf():\n    assert NAF\n"
    assert without_ours(source) == kept


def test_naf_is_listed_once(tmp_path: Path) -> None:
    clone(tmp_path)
    for _ in range(2):
        insert(tmp_path)
    for name, lines in INSERTED.items():
        text = (tmp_path / name).read_text(encoding="utf-8")
        assert [text.count(line) for line in lines.values()] == [1] * len(lines)


def test_another_folder_is_refused_and_stays_as_it_is(tmp_path: Path) -> None:
    with pytest.raises(ConfigurationError, match=r"is no clone of sb3-contrib: it has no sb3_contrib/__init__[.]py"):
        main([str(tmp_path)])
    (clone(tmp_path) / "README.md").write_text("# Another\n")
    with pytest.raises(ConfigurationError, match=r"no line of .*README[.]md begins with '- \[PPO with invalid'"):
        main([str(tmp_path)])
    assert "naf" not in (tmp_path / "docs" / "index.rst").read_text() and not (tmp_path / "tests").exists()
