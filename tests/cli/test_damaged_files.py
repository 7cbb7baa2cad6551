"""Files and folders that somebody damaged, or that a former version of the package wrote."""

import json
import shutil
from pathlib import Path

import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st
from laboratory import need
from terminal import Answer, done, run, tree

from sarah.errors import ConfigurationError
from sarah.runs.config import TrainingConfig
from sarah.runs.config_files import read_config
from sarah.runs.run_folder import RunFolder

PARAMETERS = {f"P{index}": 1.0 for index in range(1, 6)}
EPISODE = "index,return,steps_per_second,x,y,P1,P2,P3,P4,P5\n0,1,1,0,0,1,1,1,1,1\n"


def learned(**changes: object) -> str:
    return json.dumps({"parameters": PARAMETERS | changes})


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("episodes: 10\nepisodes: 20\n", "key 'episodes' is given twice"),
        (f"seed: {'9' * 5000}", "seed must be a whole number, not '9999"),
        ("!!python/object/apply:os.system ['touch hacked']", "tags are not allowed"),
        ("a: &a [x, x]\nepisode: [*a, *a]", "anchors and aliases are not allowed, such as 'a'"),
        ("[" * 5000, "it is not YAML: maximum recursion depth exceeded"),
        ("\x00", "is not YAML"),
        ("\udcff\udcfe", "cannot read mine.yaml: it is not UTF-8 text"),
    ],
)
def test_configuration_files(text: str, message: str, answer: Answer, tmp_path: Path) -> None:
    (tmp_path / "mine.yaml").write_bytes(text.encode(errors="surrogateescape"))
    line = answer("sarah-train --config mine.yaml")
    assert message in line and "mine.yaml" in line


@pytest.mark.parametrize(
    ("name", "content", "command", "message"),
    [
        ("parameters.json", learned(P3=float("nan")), "sarah-eval", "P3 must be between"),
        ("parameters.json", learned(P6=1), "sarah-eval", "it names 'P1, P2"),
        ("parameters.json", "{}", "sarah-train --task balance --from", "does not hold learned parameters"),
        ("episodes.csv", EPISODE.replace("0,1,1", "0,x,1"), "sarah-figures", "cannot be read"),
        ("episodes.csv", "", "sarah-figures", "no episodes to draw"),
        ("journal.jsonl", None, "sarah-train --episodes 200 --resume", "cannot be resumed: it has no journal.jsonl"),
        ("config.yaml", "slots: 4", "sarah-train --out x --resume", "leave --out, --config and --from out"),
    ],
)
def test_damaged_run_folders(
    name: str, content: str | None, command: str, message: str, answer: Answer, tmp_path: Path
) -> None:
    run = RunFolder.create(tmp_path / "run", TrainingConfig())
    run.write_parameters({"parameters": PARAMETERS})
    (run.path / "episodes.csv").write_text(EPISODE)
    (run.path / name).unlink()
    if content is not None:
        (run.path / name).write_bytes(content.encode(errors="surrogateescape"))
    assert message in answer(f"{command} run")


KEYS = st.sampled_from(("task", "algo", "episodes", "slots", "episode", "physics", "rate", "friction", "stepping", "x"))
SCALARS = st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5)
VALUES = st.recursive(
    SCALARS, lambda inner: st.lists(inner, max_size=5) | st.dictionaries(KEYS | SCALARS, inner, max_size=3)
)
CONFIGS = st.dictionaries(KEYS, VALUES, max_size=4)


@settings(max_examples=100, derandomize=True)
@given(content=(VALUES | CONFIGS).map(yaml.safe_dump) | st.text(max_size=40))
def test_any_file_is_a_configuration_or_a_mistake(content: str, tmp_path_factory: pytest.TempPathFactory) -> None:
    path = tmp_path_factory.getbasetemp() / "any.yaml"
    path.write_text(content, encoding="utf-8", errors="replace")
    try:
        assert isinstance(read_config(TrainingConfig, path), TrainingConfig)
    except ConfigurationError as error:
        assert len(str(error).splitlines()) == 1 and "any.yaml" in str(error)


FORMER = Path(__file__).parents[1] / "former"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    need("mujoco")
    return Path(shutil.copytree(FORMER, tmp_path / "former"))


@pytest.mark.parametrize(
    "command",
    [
        "sarah-eval stepping --episodes 1",
        "sarah-eval session --episodes 1",
        "sarah-operate balance --minutes 0.1 --learner none --out ../out",
        "sarah-figures stepping balance --out ../out",
        "sarah-train --task balance --from stepping --episodes 1 --algo random --episode.time-limit 2 --out ../out",
    ],
)
def test_every_kind_is_a_subject(command: str, folder: Path) -> None:
    before = tree(folder)
    name, *arguments = command.split()
    process = done(name, *arguments, cwd=folder)
    assert tree(folder) == before
    if name == "sarah-figures":
        files = [folder / file for file in process.stdout.split()]
        assert len(files) >= 10 and all(file.stat().st_size > 5000 for file in files)


def test_no_race_is_run_in_the_folder_of_something_else(folder: Path) -> None:
    before = tree(folder)
    for kind, name in (("stepping", "training"), ("session", "session")):
        process = run("sarah-compare", "--out", str(folder / kind), cwd=folder.parent)
        assert process.returncode == 2 and f"is the folder of a {name}: name another for the race\n" in process.stderr
    assert tree(folder) == before


def test_a_complete_race_is_read_and_no_other_one_goes_on(folder: Path) -> None:
    entries = "--out race --algorithms cma-es --seeds 1 --evaluations 2 --evaluations-along 1"
    line = f"{entries} --engine mujoco --episode.time-limit 2 --episodes 6 --slots 4".split()
    shutil.copytree(folder / "stepping", folder / "race" / "cma-es-s0")
    before = tree(folder)
    refused = run("sarah-compare", *line, cwd=folder)
    assert (refused.returncode, refused.stderr.count("\n")) == (2, 1) and "sarah-sources is" in refused.stderr
    assert tree(folder) == before
    rows = "episodes,score,seconds,evaluations\n5,0.4,1.0,1\n6,0.6,1.0,2\n"
    (folder / "race" / "cma-es-s0" / "race.csv").write_text(rows)
    (folder / "race" / "cma-es-s0" / "race_scores.csv").write_text("seed,score\n0,0.5\n1,0.7\n")
    read = done("sarah-compare", *line, cwd=folder)
    assert "| cma-es | 1 | 0.600" in read.stdout, read.stderr
