"""Logs that are learned from, whoever wrote them."""

import csv
import dataclasses
from pathlib import Path
from typing import Any

import pytest
from laboratory import NEEDS_PYBULLET

from sarah.episode.from_mapping import from_mapping
from sarah.errors import ConfigurationError, SarahError
from sarah.logs.robot_log import RobotLog
from sarah.logs.simulated import about_robot
from sarah.operation.settings import BOX, SHIPPED, Change, OperationConfig
from sarah.operation.window import FELT, Window
from sarah.recognition.logs import facts_of, read_logs
from sarah.runs.session import SessionSpec
from sarah.runs.session_folder import SessionFolder
from sarah.runs.session_robot import SessionRobot

WEAK = Change(0.1, {"randomisation": {"actuator_bandwidth": 12.0}})


def window(index: int, changes: int = 0, first: float = 0.0) -> Window:
    felt = (first, *(float(number) for number in range(1, len(FELT))))
    return Window(index, 6.0 * index, 6.0, changes, SHIPPED, 0.9, 0.8, index == 1, felt)


def session(
    path: Path, seed: int = 0, robot_there: SessionRobot | None = None, felt: float = 0.0, **settings: Any
) -> Path:
    config = OperationConfig(**{"changes": (WEAK,), **settings})
    folder = SessionFolder.create(path, SessionSpec(learner="none", seed=seed, config=config), robot=robot_there)
    for one in (window(0, first=felt), window(1, first=felt), window(2, len(config.changes), felt)):
        folder.append_window(one)
    return path


def table(path: Path, **changes: Any) -> Path:
    row = {**dict(zip(BOX.names, SHIPPED, strict=True)), "observed_reward": 0.8, "fell": 0, **dict.fromkeys(FELT, 1.0)}
    row |= changes
    with path.open("w", newline="") as file:
        file.write("# somebody else's robot\n")
        writer = csv.DictWriter(file, [name for name, value in row.items() if value is not None], extrasaction="ignore")
        writer.writeheader()
        writer.writerow(row)
    return path


def test_a_session_is_cut_where_something_was_changed(tmp_path: Path) -> None:
    before, after = read_logs([session(tmp_path / "session")])
    assert (len(before.windows), len(after.windows)) == (2, 1)
    assert before.kind == "as simulated" and "actuator_bandwidth" in after.kind
    assert [one.fell for one in before.windows] == [False, True]
    assert before.windows[0].reward == 0.8  # what the robot observed, and not its score


def test_sessions_of_one_robot_are_put_together_and_of_one_kind_are_not(tmp_path: Path) -> None:
    logs = enumerate((("a", 0), ("b", 0), ("c", 1)))
    robots = read_logs([session(tmp_path / name, seed, felt=i, changes=()) for i, (name, seed) in logs])
    assert [len(robot.windows) for robot in robots] == [6, 3]
    assert robots[0].kind == robots[1].kind and robots[0].name != robots[1].name


def test_a_table_of_the_same_columns_is_a_log(tmp_path: Path) -> None:
    (robot,) = read_logs([table(tmp_path / "mine.csv", robot="mine", kind="heavy")])
    assert (robot.name, robot.kind, robot.windows[0].parameters) == ("mine", "heavy", SHIPPED)
    (robot,) = read_logs([table(tmp_path / "nameless.csv")])
    assert robot.name == "nameless"


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"P1": 7}, "P1 must be between 0 and 2"),
        ({"V4": "exec"}, "V4 must be a number"),
        ({"observed_reward": 1e300}, "observed_reward must be"),
        ({"a_x_deviation": None}, "without a_x_deviation"),
        ({"length_lag": "nan"}, "length_lag must be a number"),
        ({"robot": "x" * 1000}, "names a robot"),
        ({"changes": "many"}, "changes must be a number"),
        ({"measure_seconds": 1e9}, "measure_seconds"),
        ({"fell": "perhaps"}, "fell must be 0 or 1, not 'perhaps'"),
        ({"fell": None}, "without fell"),
        ({"changes": -1}, "changes must be a whole number from 0 on, not -1"),
        ({"steps_per_second": "3,2"}, "steps_per_second must be a number"),
    ],
)
def test_a_hostile_table_is_named_with_what_is_wrong(changes: dict[str, Any], reason: str, tmp_path: Path) -> None:
    file = table(tmp_path / "hostile.csv", **changes)
    with pytest.raises(ConfigurationError) as error:
        read_logs([file])
    assert str(file) in str(error.value) and reason in str(error.value) and "\n" not in str(error.value)


def test_a_table_whose_cells_do_not_fit_its_columns_is_refused(tmp_path: Path) -> None:
    file = table(tmp_path / "table.csv")
    text = file.read_text()
    file.write_text(text.replace("0.8,", "0,8,", 1))
    with pytest.raises(ConfigurationError, match=r"table\.csv has a row with more cells than columns"):
        read_logs([file])
    file.write_text(text.replace("observed_reward", "P1"))
    with pytest.raises(ConfigurationError, match=r"table\.csv has two columns 'P1'"):
        read_logs([file])


def test_a_table_of_a_spreadsheet_is_a_log(tmp_path: Path) -> None:
    file = table(tmp_path / "table.csv", fell="TRUE")
    file.write_text(file.read_text().split("\n", 1)[1], encoding="utf-8-sig")
    (robot,) = read_logs([file])
    assert robot.windows[0].parameters == SHIPPED and robot.windows[0].fell


def test_robots_of_one_name_and_two_kinds_stay_apart(tmp_path: Path) -> None:
    kinds = {"light": 1.0, "heavy": 2.0}
    files = [table(tmp_path / f"{kind}.csv", robot="mine", kind=kind, a_z_mean=a) for kind, a in kinds.items()]
    assert [robot.kind for robot in read_logs(files)] == ["light", "heavy"]


def test_files_of_one_name_are_named_with_their_folders(tmp_path: Path) -> None:
    files = [tmp_path / one for one in ("a/windows.csv", "b/windows.csv", "mine.csv")]
    for number, file in enumerate(files):
        file.parent.mkdir(exist_ok=True)
        table(file, a_z_mean=number)
    assert [robot.name for robot in read_logs(files)] == ["a/windows", "b/windows", "mine"]


def test_windows_that_two_logs_have_count_once(tmp_path: Path) -> None:
    path = session(tmp_path / "session", changes=())
    for other in (path, path / "windows.csv", mcap(tmp_path / "same.mcap", facts_of(OperationConfig(), 0))):
        assert [len(robot.windows) for robot in read_logs([path, other])] == [3]


@pytest.mark.parametrize(
    ("good", "bad", "reason"),
    [
        (",0.8,", ",1e300,", "observed_reward must be at most"),
        (",0.8,0,0.0", ",0.8,0,1e300", "a_x_mean must be at most"),
        (",0.8,0,", ",0.8,2,", "fell must be 0 or 1, not '2'"),
        ("0,0.0,6.0,0,", "0,0.0,6.0,9,", "after 9 changes, of 1"),
    ],
)
def test_a_hostile_session_is_named_with_what_is_wrong(good: str, bad: str, reason: str, tmp_path: Path) -> None:
    path = session(tmp_path / "session")
    text = (path / "windows.csv").read_text()
    assert good in text
    (path / "windows.csv").write_text(text.replace(good, bad, 1))
    with pytest.raises(SarahError, match=reason) as error:
        read_logs([path])
    assert str(path) in str(error.value) and "\n" not in str(error.value)


def test_a_robot_whose_name_moves_the_cursor_is_refused(tmp_path: Path) -> None:
    path = session(tmp_path / "session", robot_there=SessionRobot(robot="\x1b[31mred"))
    with pytest.raises(ConfigurationError, match="session names a robot"):
        read_logs([path])


@pytest.mark.parametrize(
    ("settings", "reason"),
    [
        ({"measure_seconds": 5.0}, "measure_seconds 5.0, not 4.0"),
        ({"robot": {"controller": {"leg_speed": 2.0}}}, "leg_speed 2.0, not 1.0"),
        ({"robot": {"physics": {"control_rate": 50}}}, "control_rate 50.0, not 100.0"),
    ],
)
def test_logs_that_cannot_be_compared_are_refused_by_name(
    settings: dict[str, Any], reason: str, tmp_path: Path
) -> None:
    config = from_mapping(OperationConfig(), settings)
    others = {item.name: getattr(config, item.name) for item in dataclasses.fields(config)}
    paths = [session(tmp_path / "first"), session(tmp_path / "other", **{**others, "changes": ()})]
    with pytest.raises(ConfigurationError, match=reason) as error:
        read_logs(paths)
    assert str(paths[1]) in str(error.value)


def test_the_log_that_differs_from_most_is_refused(tmp_path: Path) -> None:
    seconds = {"odd": 5.0, "usual": 4.0, "another": 4.0}
    paths = [table(tmp_path / f"{name}.csv", measure_seconds=its) for name, its in seconds.items()]
    with pytest.raises(ConfigurationError, match=r"odd\.csv has measure_seconds 5\.0, not 4\.0"):
        read_logs(paths)


def test_what_is_no_log_is_named(tmp_path: Path) -> None:
    with pytest.raises(ConfigurationError, match=r"notes\.txt is no log"):
        read_logs([tmp_path / "notes.txt"])
    with pytest.raises(ConfigurationError, match="at least one log"):
        read_logs([])


def mcap(path: Path, facts: dict[str, str] | None = None, duration: float = 6.0, felt: float = 0.0) -> Path:
    config = OperationConfig()
    with RobotLog(path, about_robot(config.robot, "a program", **(facts or {}))) as log:
        plain = window(0, first=felt).plain()
        log.window(6.0, {**plain, "seconds": duration})
    return path


def test_the_windows_of_an_mcap_file_are_a_log(tmp_path: Path) -> None:
    (robot,) = read_logs([mcap(tmp_path / "robot.mcap", facts_of(OperationConfig(), 3))])
    (same,) = read_logs([session(tmp_path / "session", 3, changes=())])
    assert robot.windows[0] == same.windows[0]
    assert (robot.name, robot.kind, robot.conditions) == (same.name, same.kind, same.conditions)


@NEEDS_PYBULLET
def test_kinds_with_many_differing_settings_stay_apart(tmp_path: Path) -> None:
    shared = {"engine": "mujoco", "randomisation": {"actuator_bandwidth": 12.0, "delay_seconds": 0.03, "friction": 0.5}}
    configs = [from_mapping(OperationConfig(), {"robot": {**shared, "payload": load}}) for load in (5.0, 8.0)]
    facts = [facts_of(config, 2**31 - 1) for config in configs]
    files = [mcap(tmp_path / f"{felt}.mcap", its, felt=felt) for felt, its in enumerate(facts)]
    first, second = read_logs(files)
    assert first.kind != second.kind and first.kind.startswith("engine mujoco, randomisation.friction")


def test_an_mcap_file_with_other_windows_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ConfigurationError, match=r"long\.mcap has a window of 9 s, not of 6 s"):
        read_logs([mcap(tmp_path / "long.mcap", duration=9.0)])
    with pytest.raises(ConfigurationError, match=r"settle_seconds must be between"):
        read_logs([mcap(tmp_path / "hostile.mcap", {"settle_seconds": "1e9"})])
    with pytest.raises(ConfigurationError, match=r"dimensions must be values by name, not \[1\]"):
        read_logs([mcap(tmp_path / "dimensions.mcap", {"dimensions": "[1]"})])
    with RobotLog(tmp_path / "empty.mcap", {}):
        pass
    with pytest.raises(ConfigurationError, match=r"empty\.mcap has no windows"):
        read_logs([tmp_path / "empty.mcap"])
