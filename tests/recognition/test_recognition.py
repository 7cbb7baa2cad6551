"""The file of a recognition: what was written is read back, and what others wrote is refused in one line."""

import dataclasses
from pathlib import Path

import pytest
from known_robots import LOGS, top

from sarah.errors import ConfigurationError
from sarah.operation.settings import SHIPPED
from sarah.operation.window import FELT
from sarah.recognition.learning import best_set, learn
from sarah.recognition.recognition import Recognition, read_recognition, shipped_recognition


@pytest.mark.parametrize("kind", ["nearest", "classes", "network", "model", "naf", "best"])
def test_what_was_learned_is_read_back(kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sarah.recognition.naf.STEPS", 5)
    recognition = learn(LOGS, kind)  # type: ignore[arg-type]  # one of the kinds
    file = tmp_path / "recognition.json"
    file.write_text(recognition.text())
    assert read_recognition(file) == recognition and read_recognition(file).identity == recognition.identity


def test_the_shipped_one_is_small_and_knows_robots() -> None:
    assert len(shipped_recognition().kinds) >= 20 and len(shipped_recognition().text()) < 100_000


ONE_KIND = f'{{"kinds": ["a"], "places": [[]], "sets": [{list(SHIPPED)}], "rewards": [[REWARD]], "deviations": [[0]]}}'
EMPTY_LAYER = '{"weights": [], "biases": []}'


def test_sets_that_ran_once_are_known_where_none_is_repeated() -> None:
    short = [dataclasses.replace(robot, windows=robot.windows[:6]) for robot in LOGS]  # the reference, and three once
    assert [best_set(robot) for robot in short[::2]] == [top(kind) for kind in (-1.0, 0.0, 1.0)]
    assert set(learn(short).sets) == {SHIPPED, *(top(kind) for kind in (-1.0, 0.0, 1.0))}


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("", "Expecting value"),
        ("[" * 100_000, "nested without end"),
        ("3", "must hold keys and values"),
        ('{"far": NaN}', "NaN is no number"),
        ('{"far": 1e999}', "far must be between"),
        ('{"kind": "nearer"}', "did you mean 'nearest'"),
        ('{"sets": [[1, 2]]}', "sets.0 must be 9 numbers"),
        ('{"kinds": ["a"]}', "sets.0 must be the reference"),
        ('{"kinds": ["two\\nlines"], "places": [[]]}', "a name of one line"),
        ('{"places": [[1]]}', "places must be 0 times 0 numbers"),
        ('{"centre": ["__import__"]}', "must be a number"),
        ('{"rows": [[7, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]]}', "rows.0.0 must be between"),
        (ONE_KIND.replace("REWARD", "1e6"), "rewards must be numbers from -2 to 2, not 1000000.0"),
        ('{"rows": [[0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1e6]]}', "rows.0.10 must be numbers from -2 to 2"),
        ('{"layers": [{"weights": [[1]], "biases": [0]}]}', "layers.0.weights must be 0 times 0 numbers"),
        ('{"layers": [' + f"{EMPTY_LAYER}, {EMPTY_LAYER}" + "]}", "layers.0.weights must be 1 times 0 numbers"),
        ('{"conditions": {"control_rate": -1}}', "conditions.control_rate must be between"),
    ],
)
def test_a_hostile_file_is_named_with_what_is_wrong(text: str, reason: str, tmp_path: Path) -> None:
    file = tmp_path / "recognition.json"
    file.write_text(text)
    with pytest.raises(ConfigurationError) as error:
        read_recognition(file)
    assert str(error.value).startswith(f"{file} is not a recognition") and reason in str(error.value)
    assert "\n" not in str(error.value)


def test_nothing_is_known_without_logs() -> None:
    with pytest.raises(ConfigurationError, match=r"two kinds of robots.*, and have 6 of kind -1$"):
        learn(LOGS[:1])
    alike = [one._replace(felt=(1.0,) * len(FELT)) for one in LOGS[0].windows]
    with pytest.raises(ConfigurationError, match="feel the same"):
        learn([dataclasses.replace(robot, windows=tuple(alike)) for robot in LOGS])
    assert Recognition().kinds == ()
