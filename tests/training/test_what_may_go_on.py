"""A training goes on only with the settings, the code and the versions that it was begun with."""

import dataclasses
import hashlib
import json
import re
import shutil
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import terminal
import yaml
from interrupted import EPISODE, INTERRUPTED, begun, content, go_on, interrupted

from sarah.episode.tasks import TASKS
from sarah.errors import ConfigurationError, ResumeError, RunFolderError
from sarah.recorded import folder
from sarah.runs.agent_settings import NAFSettings, settings_of
from sarah.runs.config import ALGORITHMS, TrainingConfig
from sarah.runs.config_files import read_config, settings_by_key
from sarah.runs.run_folder import RunFolder
from sarah.training import train as training
from sarah.training.train import train
from sarah.versions import LEARNING, source_hash, versions


def others(value: Any) -> Iterator[Any]:
    """Values that a setting might have instead."""
    if value is None:
        yield [0.2, 0.4]
    elif isinstance(value, bool):
        yield not value
    elif isinstance(value, (int, float)):
        yield from (
            value * 2,
            value + 1,
            value * 1.01,
            value * 0.99,
            value + 0.001,
            0.0 if isinstance(value, float) else 1,
        )
    elif isinstance(value, str):
        yield from (
            "mujoco",
            "pybullet",
            "printed",
            "described",
            "paper",
            "one-step",
            "relu",
            "cuda",
            "td3",
            "sac",
            "stepping",
            "balance",
            0.1,
        )
    elif isinstance(value, list):
        yield from ([*value[:-1], other] for other in others(value[-1] if value else 0))
        yield [*value, 7]
    elif isinstance(value, dict):
        yield from ({**value, name: other} for name in value for other in others(value[name]))


def edited(path: Path, key: str) -> None:
    """Give one setting in a ``config.yaml`` another value that is allowed."""
    settings = yaml.safe_load(path.read_text())
    original = settings_by_key(read_config(TrainingConfig, path))[key]
    *groups, name = key.split(".")
    part = settings
    for group in groups:
        part = part[group]
    for other in others(part[name]):
        previous, part[name] = part[name], other
        if key in DECIDING:  # the settings of the other one are others
            part.pop(DECIDING[key], None)
        path.write_text(yaml.safe_dump(settings))
        try:
            if settings_by_key(read_config(TrainingConfig, path))[key] != original:
                return
        except ConfigurationError:
            part[name] = previous
    raise AssertionError(f"no other value of {key} is known to be allowed")


DECIDING = {"task": "episode", "algo": "agent", "episode.engine": "physics"}
"""Settings on which it depends what others beside them there are."""


def keys_of(config: TrainingConfig) -> set[str]:
    # An extension is in the journal: tests/training/test_extension.py.
    return settings_by_key(config).keys() - {"pictures", "extended_from"}


@pytest.mark.parametrize(
    ("task", "algo"), [("balance", "naf"), *(("stepping", algo) for algo in ALGORITHMS if algo != "naf")]
)
def test_every_setting_edited_in_turn_is_refused(task: str, algo: str, tmp_path: Path) -> None:
    # Without ranks, gamma may be another.
    agent = NAFSettings(temperature=0.0, elite_share=0.0) if algo == "naf" else settings_of(algo)()
    config = TrainingConfig(task, algo, episodes=5, agent=agent, episode=TASKS[task].config_of(EPISODE))
    run = begun(tmp_path / "run", config)
    path = run.path / "config.yaml"
    written = path.read_bytes()
    assert len(keys_of(config)) > 40
    for key in keys_of(config):
        edited(path, key)
        before = content(run)
        with pytest.raises(
            ResumeError, match=rf"run cannot be resumed: (.*; )?{key} is .* here, and .* in this training"
        ):
            train(run.config(), run)
        assert content(run) == before
        path.write_bytes(written)
    go_on(run, INTERRUPTED)


@pytest.mark.parametrize("name", ["python", "sarah", "sarah-sources", *LEARNING])
def test_other_versions_are_refused(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(folder, "versions", lambda: {**versions(), name: "0.0.7"})
    run = interrupted(tmp_path / "run", TrainingConfig(algo="random", episodes=5, episode=EPISODE))
    go_on(run, INTERRUPTED)
    monkeypatch.undo()
    before = content(run)
    with pytest.raises(
        ResumeError, match=f"run cannot be resumed: {name} is {re.escape(versions()[name])} here, and 0.0.7 in this"
    ):
        train(run.config(), run)
    assert content(run) == before


def test_the_command_names_what_was_edited_and_changes_nothing(tmp_path: Path) -> None:
    run = interrupted(tmp_path / "run", TrainingConfig(algo="random", episodes=5, episode=EPISODE))
    path = run.path / "config.yaml"
    path.write_text(path.read_text().replace("time_limit: 1.2", "time_limit: 2.4").replace("seed: 0", "seed: 1"))
    before = content(run)
    resumed = terminal.run("sarah-train", "--resume", "run", cwd=tmp_path)
    assert resumed.returncode != 0
    assert resumed.stderr.splitlines()[-1] == (
        "sarah-train: error: run cannot be resumed: seed is 1 here, and 0 in this training; episode.time_limit is 2.4 "
        "here, and 1.2 in this training: put that back, or begin anew (run/config.yaml has the settings)"
    )
    assert content(run) == before


@pytest.mark.parametrize(
    "damage",
    [
        lambda first: first.replace(b'"seed":0', b'"seed":1'),
        lambda first: first[:-40] + b"\n",
        lambda first: b"",
        lambda first: b"rubbish\n",
        lambda first: b"x" * 200_000 + b"\n",
    ],
)
def test_without_the_first_row_nothing_goes_on(damage: Any, tmp_path: Path) -> None:
    run = interrupted(tmp_path / "run", TrainingConfig(algo="random", episodes=5, episode=EPISODE))
    first, *rows = run.journal_path.read_bytes().splitlines(keepends=True)
    run.journal_path.write_bytes(b"".join([damage(first), *rows]))
    before = content(run)
    with pytest.raises(ResumeError, match=r"the first row of journal.jsonl, .* is damaged or missing"):
        train(run.config(), run)
    assert content(run) == before


def test_rows_of_another_training_do_not_count(tmp_path: Path) -> None:
    config = TrainingConfig(algo="random", episodes=5, slots=1, episode=EPISODE)
    other = interrupted(
        tmp_path / "other", dataclasses.replace(config, episode=dataclasses.replace(EPISODE, time_limit=1.5))
    )
    run = begun(tmp_path / "run", config)
    _, *rows = other.journal_path.read_bytes().splitlines(keepends=True)
    with run.journal_path.open("ab") as file:
        file.writelines(rows)
    with run.journal_of(config) as journal:
        assert rows and not journal.replaying


def test_a_journal_larger_than_any_such_training_is_not_read(tmp_path: Path) -> None:
    run = begun(tmp_path / "run", TrainingConfig(algo="random", episodes=5, episode=EPISODE))
    with run.journal_path.open("ab") as file:
        file.truncate(2**40)  # takes no room on the disk
    with pytest.raises(ResumeError, match=r"journal.jsonl has 1099511627776 bytes, .* at most 10050000"):
        train(run.config(), run)


def test_a_run_folder_says_with_what_it_was_begun(tmp_path: Path) -> None:
    config = TrainingConfig(algo="random", episodes=5, episode=EPISODE)
    run = RunFolder.create(tmp_path / "run", config)
    assert run.versions() == versions() and run.versions()["sarah-sources"] == source_hash()
    (run.path / "versions.txt").write_text("torch 1.0\n")  # as of another installation, cut before its first episode
    go_on(run, INTERRUPTED)
    assert run.versions() == versions()


def test_what_others_wrote_is_printed_without_control_characters(tmp_path: Path) -> None:
    run = begun(tmp_path / "run", TrainingConfig(algo="random", episodes=5, episode=EPISODE))
    origin = json.dumps({"torch": "\x1b[31m" * 3000, "\x1b[2J": 1}).encode()
    run.journal_path.write_bytes(hashlib.sha256(origin).hexdigest()[:16].encode() + b" " + origin + b"\n")
    with pytest.raises(ResumeError) as refused:
        train(run.config(), run)
    assert str(refused.value).isprintable() and "not known" in str(refused.value)


@pytest.mark.parametrize(
    ("before", "after"),
    [
        (r'"index":\d+', b'"index":Infinity'),
        (r'"episode_return":[^,]+', b'"episode_return":1' + b"0" * 400),
        (r'"score":[^,]+', b'"score":"abc"'),
        (r'"steps":[^,]+', b'"steps":true'),
        (r'"final_position":\[[^]]+\]', b'"final_position":[1.0]'),
        (r'"termination":"\w+"', b'"termination":5'),
        (r'"termination":"\w+"', b'"termination":"flown\\naway"'),
    ],
)
def test_rows_that_no_episode_writes_are_simulated_again(
    before: str, after: bytes, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    """Also if somebody has computed their checksums."""
    run = interrupted(tmp_path / "run", TrainingConfig(algo="random", episodes=5, slots=1, episode=EPISODE))
    expected = list(run.episodes())
    first, row, *rows = run.journal_path.read_bytes().splitlines(keepends=True)
    text = re.sub(before.encode(), after.replace(b"\\", b"\\\\"), row.rstrip(b"\n").partition(b" ")[2], count=1)
    forged = b"%08x %s\n" % (zlib.crc32(text, int(first[:8], 16)), text)
    run.journal_path.write_bytes(b"".join([first, forged, *rows]))
    train(run.config(), run)
    assert list(run.episodes())[:3] == expected[:3] and "damaged rows: 1" in caplog.text


PACKAGE = Path(training.__file__).parents[1]


def test_the_hash_of_the_sources_tells_states_of_the_code_apart(tmp_path: Path) -> None:
    def copy(name: str) -> Path:
        return shutil.copytree(PACKAGE, tmp_path / name, ignore=shutil.ignore_patterns("__pycache__"))

    assert source_hash(copy("same")) == source_hash()
    hashes = {source_hash()}
    for name in ("control/hip_law.py", "agents/naf.py", "urdf/sarah.urdf.xacro", "episode/parameter_sets.json"):
        file = copy(name.replace("/", " ")) / name
        file.write_text(file.read_text() + "\n")
        hashes.add(source_hash(file.parents[1]))
    moved = copy("moved")
    (moved / "control" / "hip_law.py").rename(moved / "control" / "hips.py")
    assert len(hashes | {source_hash(moved)}) == 6
    described = copy("described")
    (described / "notes.txt").write_text("no source")
    assert source_hash(described) == source_hash()


def test_how_results_are_shown_changes_none(tmp_path: Path) -> None:
    """A corrected label must leave trainings that go on, and workers that run, as they are."""
    copy = shutil.copytree(PACKAGE, tmp_path / "copy", ignore=shutil.ignore_patterns("__pycache__"))
    for name in ("viewer/page.py", "reports/report.py", "pictures/style.py", "cli/train.py"):
        (copy / name).write_text((copy / name).read_text() + "\n")
    assert source_hash(copy) == source_hash()
    other = shutil.copytree(copy, tmp_path / "other")
    (other / "training" / "reports").mkdir()
    (other / "training" / "reports" / "more.py").write_text("")
    assert source_hash(other) != source_hash()


def test_who_begins_in_the_folder_of_an_interrupted_training_is_told_how_to_go_on(tmp_path: Path) -> None:
    run = begun(tmp_path / "run", TrainingConfig())
    with pytest.raises(RunFolderError, match=r"run is not empty: .*, or go on with sarah-train --resume \S+run$"):
        RunFolder.create(run.path, TrainingConfig())
