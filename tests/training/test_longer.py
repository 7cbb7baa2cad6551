"""A finished training or session goes on as if it had been meant so, and one that learns nothing stands beside it."""

import dataclasses
import itertools
import re
import shutil
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from interrupted import EPISODE, trained
from operated import KEPT, interrupted_after, quick
from terminal import run, tree

from sarah.errors import ConfigurationError, ResumeError, TrainingInterruptedError
from sarah.operation.settings import SHIPPED, Change, OperationConfig
from sarah.runs.config import TrainingConfig
from sarah.runs.run_folder import RunFolder
from sarah.runs.session import SessionSpec
from sarah.runs.session_folder import SessionFolder
from sarah.training.operate import SessionResult, add_frozen, compare_frozen, extend, operate, run_session
from sarah.training.plan import plan_of
from sarah.training.train import train


def extended(run: RunFolder, episodes: int) -> None:
    run.extend(run.config().extended_to(episodes))
    train(run.config(), run)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a training of 12 episodes, which was extended to 22, and as it was before."""
    path = tmp_path_factory.mktemp("extended")
    run = trained(path / "run", TrainingConfig(episodes=12, slots=2, episode=EPISODE))
    shutil.copytree(run.path, path / "before")
    extended(run, 22)
    return path


@pytest.fixture
def copy(folder: Path, tmp_path: Path) -> RunFolder:
    """The extended training, as if it had not been finished."""
    copy = RunFolder(shutil.copytree(folder / "run", tmp_path / "copy"))
    copy.result_path.unlink()
    return copy


@pytest.mark.parametrize("algo", ["naf", "cma-es"])
def test_it_is_the_training_that_was_meant_so(algo: str, tmp_path: Path) -> None:
    run = trained(tmp_path / "run", TrainingConfig(algo=algo, episodes=7, slots=2, episode=EPISODE))
    before = (run.path / "episodes.csv").read_bytes()
    extended(run, 14)
    assert (run.path / "episodes.csv").read_bytes().startswith(before) and run.config().extended_from == (7,)
    whole = trained(tmp_path / "whole", run.config())
    for name in ("config.yaml", "episodes.csv", "recommendations.csv", "progress.csv", "parameters.json"):
        assert (run.path / name).read_bytes() == (whole.path / name).read_bytes(), name


@pytest.mark.parametrize(
    ("before", "after", "words"),
    [
        ("episodes: 22", "episodes: 23", "it was extended to 22 there, and would be extended to 23 here"),
        ("- 12", "- 11", "episodes is 11 here, and 12 in this training"),
    ],
)
def test_it_cannot_be_extended_to_two_budgets(before: str, after: str, words: str, copy: RunFolder) -> None:
    copy.specification_path.write_text(copy.specification_path.read_text().replace(before, after))
    with pytest.raises(ResumeError, match=words):
        train(copy.config(), copy)


@pytest.mark.parametrize("new_rows", [0, 4])
def test_a_cut_extension_goes_on_to_the_same_end(new_rows: int, folder: Path, copy: RunFolder) -> None:
    rows = copy.journal_path.read_bytes().splitlines(keepends=True)
    extension = next(index for index, row in enumerate(rows) if b'"extended_to"' in row)
    copy.journal_path.write_bytes(b"".join(rows[: extension + new_rows]))
    train(copy.config(), copy)
    for name in ("journal.jsonl", "episodes.csv", "parameters.json"):
        assert (copy.path / name).read_bytes() == (folder / "run" / name).read_bytes()


@pytest.mark.parametrize(
    ("name", "options", "words"),
    [
        ("before", "--episodes 30 --agent.tau 0.5", "agent.tau is 0.02 in this training, not 0.5"),
        ("before", "--episodes 2", "episodes is 12 in this training, not 2"),
        ("before", "--episodes 30 --scheduler nowhere://127.0.0.1:1", "nowhere"),  # there are no workers
        ("copy", "--episodes 30", "it can be extended once it is finished"),
    ],
)
def test_a_refused_extension_changes_nothing(
    name: str, options: str, words: str, folder: Path, copy: RunFolder
) -> None:
    path = copy.path if name == "copy" else folder / name
    before = tree(path)
    refused = run("sarah-train", "--resume", str(path), *options.split(), cwd=folder)
    assert refused.returncode == 2 and words in refused.stderr and tree(path) == before


def test_stages_rise() -> None:
    config = TrainingConfig(episodes=200, extended_from=(60, 100))
    assert [(stage.end, stage.episodes) for stage in plan_of(config).stages] == [(60, 60), (100, 40), (200, 100)]
    assert config.extended_to(300).stages == (60, 100, 200, 300)
    assert OperationConfig(minutes=20, extended_from=(5, 10)).extended_to(30).stages == (5.0, 10.0, 20.0, 30.0)
    kind: Any
    for kind, unit in ((TrainingConfig, "episodes"), (OperationConfig, "minutes")):
        for extended_from in ((200,), (100, 60), (60, 60)):
            with pytest.raises(ConfigurationError, match=f"extended_from must be in rising order and below {unit}"):
                kind(**{unit: 200, "extended_from": extended_from})
    with pytest.raises(ConfigurationError, match="extended_from must be in rising order and below episodes"):
        TrainingConfig(episodes=200, extended_from=(0,))


CONFIG = quick(0.1, {"push": {"newtons": 200.0}}, changes=(Change(0.05, {"payload": 2.0}),))
SPEC = SessionSpec(SHIPPED, "random", 3, CONFIG)
LONGER = 0.2
"""Duration of the longer sessions, in min."""


def made(path: Path, spec: SessionSpec) -> Path:
    """The folder of a finished session that was compared with the one without learning."""
    folder = SessionFolder.create(path, spec, compare_frozen=True)
    compare_frozen(folder, spec, operate(folder, spec))
    return path


@pytest.fixture(scope="module")
def finished(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return made(tmp_path_factory.mktemp("sessions") / "finished", SPEC)


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The longer session, in one go."""
    return made(tmp_path_factory.mktemp("sessions") / "whole", SPEC.extended_to(LONGER))


def in_pieces(run: Callable[..., SessionResult]) -> SessionResult:
    """Result of a session that is interrupted after every window."""
    for windows in itertools.count(1):
        with suppress(TrainingInterruptedError):
            return run(interrupted=interrupted_after(windows))
    raise AssertionError("it never ends")


def test_an_extension_cut_after_every_window_ends_the_same(finished: Path, whole: Path, tmp_path: Path) -> None:
    folder = SessionFolder(shutil.copytree(finished, tmp_path / "cut"))
    spec = extend(folder, LONGER)
    assert spec == SPEC.extended_to(LONGER) == folder.spec() and not folder.is_finished
    result = in_pieces(partial(operate, folder, spec))
    in_pieces(partial(compare_frozen, folder, spec, result))
    for name in (*KEPT, *(f"frozen/{name}" for name in KEPT)):
        assert (folder.path / name).read_bytes() == (whole / name).read_bytes(), name


@pytest.mark.parametrize("learner", ["naf", "cma-es", "random"])
def test_who_does_not_look_ahead_does_as_in_a_long_session(learner: str) -> None:
    spec = dataclasses.replace(SPEC, learner=learner)
    longer = dataclasses.replace(spec, config=dataclasses.replace(spec.config, minutes=LONGER))
    assert run_session(spec.extended_to(LONGER)) == run_session(longer)


@pytest.mark.parametrize(
    ("stages", "words"),
    [
        ([0.1, 0.15, 0.2], "it was extended to 0.2 there, and would be extended to 0.15 here"),
        ([0.1, 0.25], "it was extended to 0.2 there, and would be extended to 0.25 here"),
        ([0.1], "it was extended to 0.2 there, and would be not extended here"),
        ([0.15, 0.2], "config.minutes is 0.15 here, and 0.1 in this session"),
    ],
)
def test_a_session_was_not_extended_otherwise(whole: Path, tmp_path: Path, stages: list[float], words: str) -> None:
    folder = SessionFolder(shutil.copytree(whole, tmp_path / "other"))
    config = dataclasses.replace(SPEC.config, minutes=stages[-1], extended_from=tuple(stages[:-1]))
    folder.extend(other := dataclasses.replace(SPEC, config=config))
    before = folder.journal_path.read_bytes()
    with pytest.raises(ResumeError, match=f"cannot be resumed: {re.escape(words)}"):
        operate(folder, other)
    assert folder.journal_path.read_bytes() == before


def test_what_is_refused_changes_nothing(finished: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = SessionFolder(shutil.copytree(finished, tmp_path / "mine"))
    shutil.rmtree(folder.frozen_path)
    before = tree(folder.path)
    monkeypatch.setattr("sarah.recorded.folder.versions", lambda: {"torch": "of tomorrow"})
    for refused in (partial(extend, folder, LONGER), partial(add_frozen, folder)):
        with pytest.raises(ResumeError, match="torch is of tomorrow here"):
            refused()
    with pytest.raises(ConfigurationError, match="extended_from must be in rising order and below minutes"):
        extend(folder, 0.1)
    assert tree(folder.path) == before


def test_without_learning_the_same_robot_meets_the_same(finished: Path, whole: Path, tmp_path: Path) -> None:
    """And the session itself is as it was, but for its picture, which shows both."""
    frozen = run_session(dataclasses.replace(SPEC, learner="none"))
    assert SessionFolder(finished / "frozen").windows() == list(frozen.windows)
    assert {window.parameters for window in frozen.windows} == {SHIPPED}
    alone = SessionFolder.create(tmp_path / "alone", SPEC)
    operate(alone, SPEC)
    for name in KEPT:
        assert (finished / name).read_bytes() == (alone.path / name).read_bytes(), name
    assert (finished / "session.png").read_bytes() != (alone.path / "session.png").read_bytes()
