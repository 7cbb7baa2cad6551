"""The parameters that the package ships: they are those of the result, they step, and they survive pushes."""

import dataclasses
import json
import subprocess
import sys
from pathlib import Path

import pytest

from experiments import record
from experiments.robot.shipped_parameters import CONDITIONS, ship
from experiments.robot.shipping import DIGITS
from sarah.episode.episode import simulate
from sarah.episode.evaluation import evaluate
from sarah.episode.parameter_sets import PARAMETER_SETS
from sarah.episode.push import Push, PushedConfig
from sarah.episode.shipped import FILE, shipped
from sarah.episode.tasks import BALANCE, BalanceConfig
from sarah.episode.tasks.balance import TRAINED_STEPPING

SEEDS = range(1000, 1004)


def test_the_packages_file_says_what_the_result_says(tmp_path: Path) -> None:
    ship(record.read("shipped_parameters"), tmp_path / FILE.name)
    assert (tmp_path / FILE.name).read_text(encoding="utf-8") == FILE.read_text(encoding="utf-8")


def test_a_set_keeps_its_origin_as_long_as_it_ships(tmp_path: Path) -> None:
    result = record.read("shipped_parameters")
    rows = [{**row, "V1": "1.23"} if row["set"] == "balance" else row for row in result.rows]
    ship(dataclasses.replace(result, rows=rows, commit="another"), tmp_path / FILE.name)
    written = json.loads((tmp_path / FILE.name).read_text(encoding="utf-8"))
    assert written["stepping"]["origin"] == shipped()["stepping"]["origin"]
    assert written["balance"]["origin"]["commit"] == "another" and written["balance"]["parameters"]["V1"] == 1.23


@pytest.mark.parametrize("name", shipped())
def test_every_figure_is_there_and_every_value_has_two_digits(name: str) -> None:
    content = shipped()[name]
    assert all(set(of_engine) == set(CONDITIONS) for of_engine in content["figures"].values())
    values = [*content["parameters"].values(), *content["settings"].get("stepping", ())]
    assert values == [round(value, DIGITS) for value in values]


def test_the_balance_task_steps_with_the_shipped_steps() -> None:
    stepping = PARAMETER_SETS["stepping"].spec.parameters
    assert BALANCE.episode.stepping == TRAINED_STEPPING == stepping


@pytest.mark.parametrize("name", PARAMETER_SETS)
def test_every_set_steps_by_its_sensors(name: str) -> None:
    spec = PARAMETER_SETS[name].spec
    calm = dataclasses.replace(spec.config, time_limit=8.0)
    if isinstance(calm, BalanceConfig):
        calm = dataclasses.replace(calm, push=Push(newtons=(0.0, 0.0)))
    found = evaluate(spec.task, spec.parameters, calm, SEEDS[:2])
    assert found.is_gait and found.survival_rate == 1.0


@pytest.mark.parametrize(("name", "newtons"), [("paper", 50.0), ("stepping", 50.0), ("balance", 100.0)])
def test_every_set_survives_most_pushes_of_its_kind(name: str, newtons: float) -> None:
    spec = PARAMETER_SETS[name].spec
    push = Push(newtons=(newtons, newtons), at_seconds=(2.0, 3.0))
    shared = {**vars(spec.config), "time_limit": 8.0, "push": push}
    config = BalanceConfig(**shared) if name == "balance" else PushedConfig(**shared)
    assert evaluate(spec.task, spec.parameters, config, SEEDS).survival_rate > 0.5


def test_what_commands_show_without_arguments_comes_back_from_its_push() -> None:
    spec = PARAMETER_SETS["balance"].spec
    result = simulate(dataclasses.replace(spec, config=dataclasses.replace(spec.config, time_limit=12.0)))
    assert BALANCE.config_of(spec.config).push.newtons[0] > 0.0 and result.survived


def test_importing_the_package_does_not_read_the_file() -> None:
    program = "import sys, sarah\nsys.exit('sarah.episode.shipped' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", program]).returncode == 0
