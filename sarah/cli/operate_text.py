"""What ``sarah-operate`` prints while a session runs, and at its end."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from sarah.cli.interruption import interruptible
from sarah.files import quoted
from sarah.operation.settings import PARAMETERS
from sarah.runs.session import SessionSpec

if TYPE_CHECKING:
    from sarah.operation.window import Window
    from sarah.training.operate import SessionResult

COMMAND = "sarah-operate"


def watched(
    run: Callable[[Callable[[Window], None], Callable[[], bool]], SessionResult],
    spec: SessionSpec,
    path: Path,
    title: str = "",
) -> SessionResult:
    """Run a session with a progress bar; if it stops early, the message says how to go on.

    :param run: function that runs it, of one that is called with every window and one that says whether to stop
    :param spec: specification of the session
    :param path: path of its folder
    :param title: words before the bar
    """
    from tqdm import tqdm

    go_on = f"go on with {COMMAND} --resume {quoted(path)}"
    falls, seconds = 0, 60.0 * spec.config.minutes
    bar = tqdm(total=seconds, desc=title, disable=None, bar_format="{l_bar}{bar}| {n:.0f} of {total:.0f} s{postfix}")

    def show(window: Window) -> None:
        nonlocal falls
        falls += window.fell
        worth = "observed" if window.score is None else "score"
        shown = {"window": window.index, worth: f"{window.worth:.2f}", "falls": falls, "changes": window.changes}
        bar.set_postfix(shown)
        bar.update(min(window.end, seconds) - bar.n)

    with bar, interruptible(COMMAND, "window", go_on) as interrupted:
        return run(show, interrupted)


def summarise(result: SessionResult, frozen: SessionResult | None, spec: SessionSpec, path: Path) -> None:
    """Print what a session came to.

    :param result: result of the session
    :param frozen: result of the same session without learning, if there is one
    :param spec: specification of the session
    :param path: path of its folder
    """
    named = zip((parameter.name for parameter in PARAMETERS), result.parameters, strict=True)
    print("\nleft with   " + ", ".join(f"{name} = {value:.2f}" for name, value in named))
    has_scores = all(window.score is not None for window in result.windows)
    print(f"{'score      ' if has_scores else 'observed   '} {scores_of(result)}")
    print(f"falls       {result.falls} in {len(result.windows)} windows")
    if spec.learner == "recognise":
        _say_recognised(result, spec, path)
    if frozen is not None:
        print(f"frozen      {scores_of(frozen)}; falls: {frozen.falls} in {len(frozen.windows)} windows")
    for change in spec.config.changes[result.windows[-1].changes :]:
        print(f"no change   at minute {change.minute:g}: no window began after it")
    print(f"folder      {path}")


def _say_recognised(result: SessionResult, spec: SessionSpec, path: Path) -> None:
    from sarah.recognition.recognition import read_recognition, shipped_recognition
    from sarah.recognition.summary import known_set_run, likeness
    from sarah.runs.session_folder import SessionFolder

    recognition = read_recognition(SessionFolder(path).recognition_path) if spec.recognition else shipped_recognition()
    print(f"recognised  {likeness(recognition, result.windows, spec.config.robot.scale)}")
    print(f"known sets  {known_set_run(recognition, result.windows, result.parameters)}")


def scores_of(result: SessionResult) -> str:
    """Mean score of a session, and how it went from its first fifth to its last; without scores, the observed reward.

    :param result: result of the session
    """
    scores = [window.worth for window in result.windows]
    fifth = max(1, len(scores) // 5)
    first, last = sum(scores[:fifth]) / fifth, sum(scores[-fifth:]) / fifth
    windows = "window" if fifth == 1 else f"{fifth} windows"
    return f"{result.mean_score():.3f}: {first:.3f} in the first {windows}, {last:.3f} in the last"
