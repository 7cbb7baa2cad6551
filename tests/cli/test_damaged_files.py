"""Configuration files and run folders that somebody damaged: one line that names what is wrong."""

import json
from collections.abc import Callable
from pathlib import Path

import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from sarah.errors import ConfigurationError
from sarah.runs.config import TrainingConfig
from sarah.runs.config_files import read_config
from sarah.runs.run_folder import RunFolder

PARAMETERS = {f"P{index}": 1.0 for index in range(1, 6)}
EPISODE = "index,return,steps_per_second,x,y,P1,P2,P3,P4,P5\n0,1,1,0,0,1,1,1,1,1\n"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("episodes: 10\nepisodes: 20\n", "key 'episodes' is given twice"),
        ("1: 2", "line 1: a key must be a text, not 1"),
        (f"seed: {'9' * 5000}", "seed must be a whole number, not '9999"),
        (f"episode: {{time_limit: {'9' * 400}}}", "time_limit must be a number that a float can hold"),
        ("!!python/object/apply:os.system ['touch hacked']", "tags are not allowed"),
        (
            "a: &a [x, x, x, x]\nb: &b [*a, *a, *a, *a]\nepisode: [*b, *b, *b]",
            "anchors and aliases are not allowed, such as 'a'",
        ),
        ("[" * 5000, "it is not YAML: maximum recursion depth exceeded"),
        ("episodes: 1" + ":1" * 5000 + ".5", "episodes must be a whole number, not '1:1:1"),
        ("\x00", "is not YAML"),
    ],
)
def test_configuration_files(text: str, message: str, answer: Callable[[str], str], tmp_path: Path) -> None:
    (tmp_path / "mine.yaml").write_text(text)
    line = answer("sarah-train --config mine.yaml")
    assert message in line and "mine.yaml" in line


def test_a_file_that_is_no_text(answer: Callable[[str], str], tmp_path: Path) -> None:
    (tmp_path / "mine.yaml").write_bytes(b"\xff\xfe\x00\x80")
    assert "cannot read mine.yaml: it is not UTF-8 text" in answer("sarah-train --config mine.yaml")


@pytest.mark.parametrize(
    ("name", "content", "command", "message"),
    [
        ("parameters.json", "[" * 60_000, "sarah-eval", "parameters.json does not hold learned parameters"),
        (
            "parameters.json",
            json.dumps({"parameters": {**PARAMETERS, "P3": float("nan")}}),
            "sarah-eval",
            "P3 must be between",
        ),
        ("parameters.json", json.dumps({"parameters": {**PARAMETERS, "P2": "1"}}), "sarah-eval", "P2 must be between"),
        ("parameters.json", json.dumps({"parameters": PARAMETERS | {"P6": 1}}), "sarah-eval", "it names 'P1, P2"),
        ("parameters.json", "{}", "sarah-train --task balance --from", "does not hold learned parameters"),
        ("config.yaml", "episods: 5", "sarah-figures", "config.yaml: unknown key 'episods'"),
        ("episodes.csv", EPISODE.replace("0,1,1", "0,x,1"), "sarah-figures", "cannot be read"),
        ("episodes.csv", EPISODE.replace("0,1,1", "0,nan,1"), "sarah-figures", "must be a number, not 'nan'"),
        ("episodes.csv", "", "sarah-figures", "no episodes to draw"),
        ("episodes.csv", "a,b\n\udcff\n", "sarah-figures", "cannot be read"),
        ("journal.jsonl", None, "sarah-train --episodes 200 --resume", "cannot be resumed: it has no journal.jsonl"),
        ("config.yaml", "slots: 4", "sarah-train --out x --resume", "leave --out, --config and --from out"),
    ],
)
def test_damaged_run_folders(
    name: str, content: str | None, command: str, message: str, answer: Callable[[str], str], tmp_path: Path
) -> None:
    run = RunFolder.create(tmp_path / "run", TrainingConfig())
    run.write_parameters({"parameters": PARAMETERS})
    (run.path / "episodes.csv").write_text(EPISODE)
    if content is None:
        (run.path / name).unlink()
    else:
        (run.path / name).write_bytes(content.encode(errors="surrogateescape"))
    assert message in answer(f"{command} run")


KEYS = ("task", "algo", "episodes", "seed", "slots", "episode", "physics", "rate", "friction", "stepping", "x")
SCALARS = st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5)
VALUES = st.recursive(
    SCALARS,
    lambda inner: st.lists(inner, max_size=5) | st.dictionaries(st.sampled_from(KEYS) | SCALARS, inner, max_size=3),
    max_leaves=8,
)
CONFIGS = st.dictionaries(st.sampled_from(KEYS), VALUES, max_size=4)


@settings(max_examples=100, derandomize=True)
@given(content=(VALUES | CONFIGS).map(yaml.safe_dump) | st.text(max_size=40))
def test_any_file_is_a_configuration_or_a_mistake(content: str, tmp_path_factory: pytest.TempPathFactory) -> None:
    path = tmp_path_factory.getbasetemp() / "any.yaml"
    path.write_text(content, encoding="utf-8", errors="replace")
    try:
        assert isinstance(read_config(TrainingConfig, path), TrainingConfig)
    except ConfigurationError as error:
        assert len(str(error).splitlines()) == 1 and "any.yaml" in str(error)
