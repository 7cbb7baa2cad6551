"""What a command looks at is its argument, whatever the values of its options are called."""

import json
import subprocess
from pathlib import Path

import pytest
from terminal import BIN, run

from sarah.episode.parameter_sets import PARAMETER_SETS
from sarah.episode.push import Push, draw_push
from sarah.simulation.engines import default_engine

QUICK = ("--episodes", "2", "--json", "--episode.time-limit", "3")


def shown(*arguments: str, folder: Path) -> dict[str, object]:
    process = run("sarah-eval", *arguments, *QUICK, cwd=folder)
    assert process.returncode == 0, process.stderr
    content: dict[str, object] = json.loads(process.stdout)
    return content


def test_an_option_before_or_after_it_changes_nothing(tmp_path: Path) -> None:
    numbers, task = "1.09,0.17,0.65,1.13", ("--task", "balance")  # which is also the name of shipped parameters
    assert shown(*task, numbers, folder=tmp_path) == shown(numbers, *task, folder=tmp_path)
    pushed = ("--episode.push.newtons", "60")
    assert shown(*pushed, numbers, folder=tmp_path) == shown(numbers, *pushed, folder=tmp_path)


def test_shipped_parameters_come_with_their_settings(tmp_path: Path) -> None:
    own = shown("balance", folder=tmp_path)
    numbers = ",".join(map(str, PARAMETER_SETS["balance"].spec.parameters))
    other = shown(numbers, folder=tmp_path)  # pushed less
    assert own["parameters"] == other["parameters"] and own["score_mean"] != other["score_mean"]


def test_without_a_subject_it_is_what_comes_back_from_a_push(tmp_path: Path) -> None:
    text = run("sarah-eval", "--episodes", "2", "--episode.time-limit", "4", cwd=tmp_path).stdout
    low, high = PARAMETER_SETS["balance"].spec.config.push.newtons
    assert f"subject          balance, task balance, in {default_engine()}, pushed by {low:g} to {high:g} N\n" in text
    assert f" {PARAMETER_SETS['balance'].origin}\n" in text
    assert shown(folder=tmp_path) == shown("balance", folder=tmp_path)
    help_text = run("sarah-eval", "--help", cwd=tmp_path).stdout
    assert f"{low} {high}" in help_text and "--episode.stepping" in help_text


def test_the_page_says_where_shipped_parameters_come_from(tmp_path: Path) -> None:
    pytest.importorskip("viser")
    with subprocess.Popen([BIN / "sarah-view"], stdout=subprocess.PIPE, text=True, cwd=tmp_path) as server:
        assert server.stdout is not None
        assert server.stdout.readline() == f"balance: {PARAMETER_SETS['balance'].origin}\n"
        assert "SARAH is at http://127.0.0.1:" in server.stdout.readline()
        server.terminate()


@pytest.mark.parametrize("numbers", ["-1,0,1,0", "1, 0.2, 0.1, 0", " -.5,0,1,-1"])
def test_numbers_as_people_write_them(numbers: str, tmp_path: Path) -> None:
    values = shown(numbers, folder=tmp_path)["parameters"]
    assert list(values.values()) == [float(value) for value in numbers.split(",")]  # type: ignore[attr-defined]


def test_a_push_after_the_end_is_refused(tmp_path: Path) -> None:
    late = ("--episode.push.newtons", "80", "--episode.push.at-seconds", "5", "--episode.time-limit", "3")
    process = run("sarah-eval", "stepping", *late, cwd=tmp_path)
    assert process.returncode == 2 and "must begin before the time_limit of 3 s" in process.stderr


def test_it_says_how_its_settings_differ_from_the_tasks_and_how_episodes_ended(tmp_path: Path) -> None:
    """Pushes of 400 N to the right at 2 to 3 s topple everyone; with an end at 2.5 s only some are pushed."""
    settings = "--episode.push.newtons 400 --episode.push.degrees 0 --episode.push.at-seconds 2 3 --episode.time-limit"
    ground = "--episode.terrain.slope-degrees 2 --episode.payload 1.5"
    text = run("sarah-eval", "balance", "--episodes", "8", *f"{settings} 6 {ground}".split(), cwd=tmp_path).stdout
    rows = {line[:17].strip(): line[17:] for line in text.splitlines()}
    assert rows["subject"].endswith("pushed by 400 N")
    given = {"terrain.slope_degrees 2", "payload 1.5", "time_limit 6", "push.degrees 0", "push.at_seconds 2 to 3"}
    assert given <= set(rows["settings"].split(", "))
    assert "push.sagittal_share 0 instead of 0.5" in rows["settings"] and "pushes" not in rows
    assert rows["survival"].startswith("0 of 8 episodes; seed 1000 ") and rows["survival"].endswith("; 3 more")
    text = run("sarah-eval", "balance", "--episodes", "8", *f"{settings} 2.5".split(), cwd=tmp_path).stdout
    begins = [draw_push(Push((400.0, 400.0), at_seconds=(2.0, 3.0)), seed).begin for seed in range(1000, 1008)]
    pushed = sum(begin < 2.5 for begin in begins)
    assert f"pushes           in {pushed} of 8 episodes; the others ended before theirs" in text


def test_directions_that_are_asked_for_are_those_of_all_pushes(tmp_path: Path) -> None:
    """The shipped robot learned with half of its pushes from front or back."""
    share = ("episode", "push.sagittal_share")
    asked = ("--episode.push.degrees", "180")
    assert PARAMETER_SETS["balance"].spec.config.push.sagittal_share == 0.5
    shares = [
        shown("balance", *arguments, folder=tmp_path)[share[0]][share[1]]  # type: ignore[index]
        for arguments in ((), asked, (*asked, "--episode.push.sagittal_share=0.25"))
    ]
    assert shares == [0.5, 0.0, 0.25]


def test_json_has_all_settings_and_how_each_episode_ended(tmp_path: Path) -> None:
    content = shown("balance", "--episode.terrain.slope-degrees", "3", folder=tmp_path)
    assert content["episode"]["terrain.slope_degrees"] == [3.0, 3.0]  # type: ignore[index]
    assert content["episode"]["stepping"] == list(PARAMETER_SETS["stepping"].spec.parameters)  # type: ignore[index]
    assert content["endings"] == ["time_limit", "left_box"] and content["survival_rate"] == 0.5


def test_a_folder_of_run_folders_names_one_of_them(trained: tuple[Path, subprocess.CompletedProcess[str]]) -> None:
    folder, _ = trained
    process = run("sarah-eval", str(folder.parent), cwd=folder)
    assert process.returncode == 2 and f"it has no config.yaml, and {folder} has one" in process.stderr
