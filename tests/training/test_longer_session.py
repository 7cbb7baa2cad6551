"""A finished session goes on, and one without learning stands beside it: exactly, and what is there stays."""

import dataclasses
import itertools
import re
import shutil
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from pathlib import Path

import pytest
from operated import KEPT, interrupted_after, quick
from terminal import tree

from sarah.errors import ConfigurationError, ResumeError, TrainingInterruptedError
from sarah.operation.settings import SHIPPED, Change
from sarah.runs.session import SessionSpec
from sarah.runs.session_folder import SessionFolder
from sarah.training.operate import SessionResult, add_frozen, compare_frozen, extend, operate, run_session

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
