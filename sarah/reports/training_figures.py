"""The paper's Figures 4 to 7 from run folders, and survival against direction and force of a push.

Figures 4 to 7 show parameters and results against training steps; a training step is one episode. A single run shows
its episodes as dots, and their running median as a line. Several runs of an algorithm show the median of those lines
over the runs, and the band between their quartiles. Dots and lines show what was tried, with exploration noise; a
single run's parameters come with what was recommended. The random warm-up is shaded. Its episodes, and those that
try the recommendation at the end, are no steps of learning: a single run shows them as hollow dots, and no line goes
through them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes

from sarah.control.parameters import PAPER_STEPPING
from sarah.episode.tasks import BALANCE, STEPPING, Task
from sarah.files import make_folder
from sarah.pictures.colours import algorithm_colours, algorithm_label
from sarah.pictures.style import COLUMN_WIDTH, own_style, save
from sarah.reports.race_entry import RaceCurve
from sarah.reports.robustness import PushedEpisode
from sarah.reports.training_curves import RunCurves, read_curves
from sarah.reports.uncertainty import standard_error
from sarah.runs.run_record import RunRecord

WINDOW = 15
"""Number of episodes in the window of the running median."""
SURVIVAL_MARKS = {True: ("survived", ".", "#0072B2"), False: ("did not", "x", "#D55E00")}
"""Label, marker and colour of pushes that the robot survived, and of others."""
WARM_UP_LABEL = "random warm-up"

Panels = list[tuple[str, str]]
"""Column of ``episodes.csv`` and label of each panel, from top to bottom."""
RETURN, STEPS = ("return", "return (m³ s)"), ("steps_per_second", "steps per second")
PAPER_FIGURES: dict[str, tuple[str, Panels, str]] = {
    STEPPING.name: ("figure_4_reward_and_frequency", [RETURN, STEPS], "figure_5_parameters"),
    BALANCE.name: (
        "figure_6_reward_and_position",
        [RETURN, ("x", "final x (m)"), ("y", "final y (m)")],
        "figure_7_parameters",
    ),
}
"""Figures of the paper, by task: name and panels of the outcome, and name of the parameters."""
PAPER = dict(zip(STEPPING.parameter_names[:3], PAPER_STEPPING[:3], strict=True))
"""Values of P1 to P3 that the paper's training found."""


def figures_of(task: Task) -> dict[str, Panels]:
    """Panels of a task's figures by name: the paper's, or two of the same kind.

    :param task: task of the trainings
    """
    own_return = ("return", "return")  # in a unit that only its author knows
    own = (f"{task.name}_reward_and_frequency", [own_return, STEPS], f"{task.name}_parameters")
    outcome, panels, parameters = PAPER_FIGURES.get(task.name, own)
    return {outcome: panels, parameters: [(parameter.name, parameter.label) for parameter in task.parameters]}


def draw_figures(runs: Sequence[RunRecord], folder: Path) -> list[Path]:
    """Draw Figures 4 and 5 of First Trainings, 6 and 7 of Second Trainings, and others' like them, as PNG and PDF.

    :param runs: records of the trainings whose episodes are drawn
    :param folder: folder for the figures, which is made if it does not exist
    :return: the files
    :raises RunFolderError: if a run folder has no episodes, or damaged ones; nothing is drawn then
    """
    of_task = {run.config.task.identity: run.config.task for run in runs}
    curves = {
        task: read_curves([run for run in runs if run.config.task.identity == identity], task)
        for identity, task in of_task.items()
    }
    make_folder(folder)
    files = []
    with own_style():
        for task, drawn in curves.items():
            for name, panels in figures_of(task).items():
                files += _draw(drawn, panels, folder / name)
    return files


def _draw(curves: Sequence[RunCurves], panels: Panels, path: Path) -> list[Path]:
    figure, axes = plt.subplots(
        len(panels),
        1,
        sharex=True,
        squeeze=False,
        figsize=(COLUMN_WIDTH, 1.0 + 1.1 * len(panels)),
        layout="constrained",
    )
    colours = algorithm_colours(curve.algorithm for curve in curves)
    for axis, (column, quantity) in zip(axes[:, 0], panels, strict=True):
        _mark_warm_up(axis, curves)
        for curve in curves:
            label = algorithm_label(curve.algorithm)
            if len(curves) == 1 and len(curve.recommended.get(column, ())):
                label += ", tried"
                _draw_recommended(axis, curve, column)
            _draw_panel(axis, curve, column, label, colours[curve.algorithm])
        if column in PAPER:
            axis.axhline(PAPER[column], color="black", linewidth=0.8, linestyle=":", label="paper")
        axis.set_ylabel(quantity)
    axes[-1, 0].set_xlabel("training steps (episodes)")
    figure.align_ylabels()
    handles, labels = axes[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper right", ncols=2, columnspacing=1.2, handlelength=1.5)
    return save(figure, path)


def _mark_warm_up(axis: Axes, curves: Sequence[RunCurves]) -> None:
    """Shade the random episodes. Of algorithms with fewer of them, a line goes through the shade."""
    longest = max(curve.warm_up for curve in curves)
    if longest == 0:
        return
    is_shared = all(curve.warm_up == longest for curve in curves)
    label = WARM_UP_LABEL if is_shared else f"{WARM_UP_LABEL} of some"
    axis.axvspan(0.5, longest + 0.5, color="0.88", linewidth=0, label=label, zorder=0)


def _draw_panel(axis: Axes, curves: RunCurves, column: str, label: str, colour: str) -> None:
    values, learned = curves.columns[column], slice(curves.warm_up, curves.learning)
    steps = np.arange(1, values.shape[1] + 1)
    smooth = _running_median(values[:, learned])
    if len(values) == 1:
        dots: dict[str, Any] = {"linestyle": "none", "marker": "o", "markersize": 1.6, "color": colour, "alpha": 0.5}
        axis.plot(steps[learned], values[0, learned], markeredgewidth=0, **dots)
        dots |= {"markerfacecolor": "none", "markeredgewidth": 0.4}
        axis.plot(steps[: curves.warm_up], values[0, : curves.warm_up], **dots)
        if curves.learning < len(steps):
            axis.plot(steps[curves.learning :], values[0, curves.learning :], label="compared at the end", **dots)
    else:
        low, high = np.quantile(smooth, (0.25, 0.75), axis=0)
        axis.fill_between(steps[learned], low, high, color=colour, alpha=0.25, linewidth=0)
        label += f", {len(values)} runs"
    axis.plot(steps[learned], np.median(smooth, axis=0), color=colour, linewidth=1.2, label=label)


def _running_median(values: np.ndarray) -> np.ndarray:
    """Median around each episode, run by run; near the ends the window holds fewer episodes."""
    windows = (slice(max(0, index - WINDOW // 2), index + WINDOW // 2 + 1) for index in range(values.shape[1]))
    return np.array([np.median(values[:, window], axis=1) for window in windows]).reshape(values.T.shape).T


def _draw_recommended(axis: Axes, curves: RunCurves, column: str) -> None:
    """Draw what the training would have recommended, each time until it was asked again."""
    episodes, values = curves.recommended["episodes"], curves.recommended[column]
    axis.plot(episodes, values, color="0.25", linewidth=0.9, drawstyle="steps-post", label="recommended")


def draw_race(curves: Sequence[RaceCurve], path: Path) -> list[Path]:
    """Draw the score of each algorithm's recommendations against episodes: median and quartiles over its runs.

    Steps show that a recommendation counts until the next one: nothing is known in between. Dots beside them are the
    mean final scores in all judging episodes, with their standard errors over trainings and episodes.

    :param curves: scores of all trainings
    :param path: path of the picture, without suffix
    :return: the files, PNG and PDF
    """
    with own_style():
        figure, (axis, ends) = plt.subplots(
            1,
            2,
            sharey=True,
            width_ratios=(4, 1),
            figsize=(COLUMN_WIDTH, 0.9 * COLUMN_WIDTH),
            layout="constrained",
        )
        colours = algorithm_colours(curve.algo for curve in curves)
        for place, algo in enumerate(dict.fromkeys(curve.algo for curve in curves)):
            runs = [curve for curve in curves if curve.algo == algo]
            episodes = runs[0].episodes
            low, middle, high = np.quantile([run.scores for run in runs], (0.25, 0.5, 0.75), axis=0)
            axis.fill_between(episodes, low, high, step="post", color=colours[algo], alpha=0.15, linewidth=0)
            label = f"{algorithm_label(algo)} ({len(runs)})"
            axis.plot(episodes, middle, drawstyle="steps-post", color=colours[algo], linewidth=1.2, label=label)
            final = np.array([run.final for run in runs])
            ends.errorbar(place, final.mean(), standard_error(final), fmt="o", markersize=2.5, color=colours[algo])
        axis.set_xlabel("episodes")
        axis.set_ylabel("score on unseen seeds")
        ends.set_xlabel("final")
        ends.set_xticks([])
        ends.margins(x=0.2)
        figure.legend(loc="outside upper center", ncols=2)  # three columns would not fit for eight algorithms
        return save(figure, path)


def draw_survival(controllers: Mapping[str, Sequence[PushedEpisode]], path: Path) -> list[Path]:
    """Draw direction and force of every push, and whether the robot survived it: a polar plot for each controller.

    :param controllers: pushed episodes, by name of the controller
    :param path: path of the picture, without suffix
    :return: the files, PNG and PDF
    """
    with own_style():
        figure, axes = plt.subplots(
            1,
            len(controllers),
            squeeze=False,
            figsize=(COLUMN_WIDTH * len(controllers), 1.1 * COLUMN_WIDTH),
            subplot_kw={"projection": "polar"},
            layout="constrained",
        )
        for axis, (name, episodes) in zip(axes[0], controllers.items(), strict=True):
            for survived, (label, marker, colour) in SURVIVAL_MARKS.items():
                pushes = [(e.radians, e.newtons) for e in episodes if e.result.survived is survived]
                axis.plot(*np.array(pushes).reshape(-1, 2).T, marker, color=colour, markersize=3, label=label)
            axis.set_title(name)
            axis.set_rlim(0.0)
            axis.set_rgrids(sorted({e.newtons for e in episodes}), fmt="%.3g N", angle=67.5, fontsize=6)
            axis.set_thetagrids((0, 90, 180, 270), ("right", "forward", "left", "back"))
        figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=2)
        return save(figure, path)
