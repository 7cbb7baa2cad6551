"""A number from outside is the same wherever it is given, and whatever type it has; what one place refuses, all do."""

import json
from collections.abc import Callable
from decimal import Decimal
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import sarah
from sarah.cli.eval import EvalOptions
from sarah.cli.operate import change_of
from sarah.cli.options import parse_options
from sarah.cli.subjects import numbers
from sarah.control.pattern_generator import PatternGenerator, Phase, SteppingParameters
from sarah.envs.operation_env import SarahOperationEnv
from sarah.episode.from_mapping import from_mapping
from sarah.errors import ConfigurationError
from sarah.formats import read_yaml
from sarah.number import number, whole_number
from sarah.robot.description import describe_robot
from sarah.robot.reading import SensorReading
from sarah.runs.agent_settings import NAFSettings
from sarah.runs.config import TrainingConfig
from sarah.runs.config_files import read_config, settings_by_key, write_config

SINGLE: Any = np.float32
"""Type whose numbers stand where the package asks for floats."""

EIGHTS = [
    *(kind(8) for kind in (np.float16, np.float32, np.float64, np.longdouble, np.int8, np.uint64, int)),
    *(np.array(8), np.array(8.0, np.float16), Fraction(8), Decimal("8.0")),
]
SETTINGS: dict[str, Callable[[Any], object]] = {
    "episode": lambda eight: sarah.EpisodeConfig(
        time_limit=eight, payload=eight, dimensions={"ankle_damping": eight / 8}
    ),
    "push": lambda eight: sarah.Push(newtons=eight, degrees=(0, eight), duration=eight),
    "terrain": lambda eight: sarah.Terrain(slope_degrees=eight, friction_left=(0, eight / 2)),
    "randomisation": lambda eight: sarah.Randomisation(imu_tilt_degrees=eight, actuator_bandwidth=eight),
    "stepping": lambda eight: sarah.BalanceConfig(stepping=(eight / 8,) * 5),
    "spec": lambda eight: sarah.EpisodeSpec([eight / 8] * 5, _whole(eight)),
    "change": lambda eight: sarah.Change(eight, {"payload": eight / 1, "terrain": {"slope_degrees": (0, eight / 1)}}),
    "session": lambda eight: sarah.SessionSpec((eight / 8,) * 9, seed=_whole(eight)),
    "training": lambda eight: TrainingConfig(
        episodes=_whole(eight), agent=NAFSettings(max_grad_norm=eight, v_layers=(_whole(eight),), elite_std=eight / 8)
    ),
    "keywords": lambda eight: from_mapping(sarah.PushedConfig(), {"time_limit": eight, "push": {"newtons": eight}}),
    "drawn push": lambda eight: sarah.DrawnPush((eight, 0, 0), eight, eight),
    "parameter": lambda eight: sarah.Parameter("A", eight / 8, eight, "", "", ""),
}
"""Makers of settings from an 8 of any type."""


def _whole(eight: Any) -> Any:
    """The 8 where only whole numbers are taken: of the same kind, if that is one."""
    return eight if isinstance(eight, (int, np.integer)) or getattr(eight, "dtype", None) is np.dtype(int) else 8


@pytest.mark.parametrize("name", SETTINGS)
def test_settings_hold_numbers_of_python_whatever_they_are_given(name: str) -> None:
    expected = repr(SETTINGS[name](8.0))
    assert "np." not in expected
    for eight in EIGHTS:
        made = SETTINGS[name](eight)
        assert repr(made) == expected, repr(eight)


def test_what_is_no_number_is_refused_in_any_type() -> None:
    for value in (True, np.bool_(True), "8", np.array([8.0]), None, 8j, np.float32("nan"), Decimal("nan")):
        with pytest.raises(ConfigurationError, match="time_limit must be between 1 and 3600 s"):
            sarah.EpisodeConfig(time_limit=value)  # type: ignore[arg-type]
        with pytest.raises(ConfigurationError, match=r"physics\.rate must be"):
            sarah.Physics(rate=value)  # type: ignore[arg-type]
        with pytest.raises(ConfigurationError, match="parameter P1 must be between 0 and 2"):
            SarahOperationEnv(first=(value, *[1.0] * 8))  # type: ignore[arg-type]


def test_truth_values_and_texts_of_numpy_are_pythons() -> None:
    with pytest.raises(ConfigurationError, match="unknown engine '3'"):
        sarah.EpisodeConfig(engine=3)  # type: ignore[arg-type]
    config = sarah.EpisodeConfig(engine=np.str_("mujoco"), randomisation=sarah.Randomisation(enabled=np.bool_(False)))  # type: ignore[arg-type]
    assert type(config.engine) is str and config.randomisation.enabled is False


def test_what_is_made_of_numpys_numbers_can_be_written_and_read(tmp_path: Path) -> None:
    change = sarah.Change(SINGLE(1), {"payload": SINGLE(5), "terrain": {"slope_degrees": np.arange(2)}})
    spec = sarah.SessionSpec(np.ones(9, np.float32), config=sarah.OperationConfig(changes=(change,)))  # type: ignore[arg-type]
    write_config(spec, tmp_path / "session.yaml")
    assert read_config(sarah.SessionSpec, tmp_path / "session.yaml") == spec
    json.dumps(settings_by_key(sarah.EpisodeConfig(time_limit=SINGLE(8))))


def test_single_precision_ends_where_settings_and_readings_begin() -> None:
    single, double = (
        PatternGenerator(SteppingParameters(*map(kind, (0.5, 1.25, 0.125, 1.0, 1.0))), dt=kind(0.015625))
        for kind in (SINGLE, float)
    )
    draw = np.random.default_rng(0)
    for _ in range(100):
        signals = [
            draw.normal(mean, 1.0, count).astype(np.float32) for mean, count in ((9, 3), (0, 3), (75, 4), (0, 6))
        ]
        single.tick(SensorReading._make(signals))
        double.tick(SensorReading(*[tuple(values.tolist()) for values in signals]))
    assert single.phase is not Phase.STAND and single.targets == double.targets
    assert (single.tilt, single.rate) == (double.tilt, double.rate) and type(single.tilt) is float
    assert describe_robot({"ankle_damping": SINGLE(1)}) is describe_robot({"ankle_damping": 1})


ACCEPTED = {"8": 8.0, "+8": 8.0, "8.": 8.0, ".5": 0.5, "1e-4": 1e-4, "1E1": 10.0, "1.0e-05": 1e-5}
REFUSED = ("0100", "1:30", "1_000", "0x10", "08.5", "१", "1e", "inf", ".nan", "5kg", "9" * 2000)


@pytest.mark.parametrize("text", ACCEPTED)
def test_spellings_of_numbers_are_the_same_everywhere(text: str) -> None:
    value = ACCEPTED[text]
    assert number(text) == read_yaml(f"a: {text}")["a"] == numbers(text)[0] == value
    assert parse_options(EvalOptions, "", ["--episode.payload", text], EvalOptions()).episode.payload == value
    assert change_of(f"{text}: payload={text}").settings == {"payload": value}
    assert value == int(value) or not text.isdigit()


@pytest.mark.parametrize("text", REFUSED)
def test_other_spellings_are_refused_by_name_everywhere(text: str, capsys: pytest.CaptureFixture[str]) -> None:
    for read in (number, whole_number, lambda text: numbers(text)):
        with pytest.raises(ValueError, match=r"must be (a (whole )?number|numbers separated by commas), not '"):
            read(text)
    with pytest.raises(ConfigurationError, match="time_limit must be a number, not '"):
        from_mapping(sarah.EpisodeConfig(), read_yaml(f"{{time_limit: '{text}'}}"))
    with pytest.raises(ConfigurationError, match="change must be a minute and a setting"):
        change_of(f"{text} : payload=3" if ":" not in text else "01: payload=3")
    for option, kind in (("--episodes", "a whole number"), ("--episode.time-limit", "a number")):
        with pytest.raises(SystemExit):
            parse_options(EvalOptions, "sarah-eval", [option, text], EvalOptions())
        assert capsys.readouterr().err.startswith(f"sarah-eval: error: {option} must be {kind}, not '{text[:9]}")
    with pytest.raises((ConfigurationError, SystemExit)):
        parse_options(EvalOptions, "sarah-eval", ["--forces", text], EvalOptions())


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("a: 1\nb: 2\na: 3", "line 3: key 'a' is given twice"),
        ("l: [{a: 1, a: 2}]", "line 1: key 'a' is given twice"),
        ("~: 3", "line 1: a key must be a text, not None"),
        ("a: 1\n---\nb: 2", "it is not YAML: expected a single document"),
        ("\ta: 1", "it is not YAML: "),
    ],
)
def test_yaml_with_a_second_meaning_is_refused(text: str, words: str) -> None:
    with pytest.raises(ConfigurationError, match=words) as caught:
        read_yaml(text)
    assert "\n" not in str(caught.value)


def test_yaml_has_no_other_types() -> None:
    texts = {"a": "off", "b": "y", "c": "2026-11-28", "d": "=", "<<": "<<", "e": "1:30", "f": "010"}
    assert read_yaml("\ufeff" + "\r\n".join(f"{name}: {text}" for name, text in texts.items())) == texts
    assert read_yaml("[~, null, true, False, '5']") == [None, None, True, False, "5"]
