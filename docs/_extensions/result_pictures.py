"""The pictures of results, drawn from their rows when the site is built.

:data:`PICTURES`, at the end, says which results each picture takes and what draws it.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path

import matplotlib.pyplot as plt
from matplotlib.figure import Figure
from matplotlib.ticker import EngFormatter, MaxNLocator
from result_columns import heading
from result_rows import chosen
from result_shapes import (
    COLOURS,
    Rows,
    draw_against,
    draw_intervals,
    draw_lines,
    draw_strips,
    grouped,
    legend,
    numbers,
    panels,
)

from experiments import record
from sarah.pictures.style import COLUMN_WIDTH, STYLE


def second_training(rows: Rows) -> Figure:
    """Where V1 to V4 settled, and survival."""
    learned = chosen(rows, "run!=V = 0")
    (neutral,) = chosen(rows, "run=V = 0")
    figure, (left, right) = panels(2, 0.35, width_ratios=(4, 3))
    survival = {"push_100_survival": "100 N", "push_125_survival": "125 N", "sagittal_115_survival": "115 N sagittal"}
    for axis, columns in ((left, {name: name for name in ("V1", "V2", "V3", "V4")}), (right, survival)):
        values = {label: numbers(learned, column) for column, label in columns.items()}
        draw_strips(axis, values, {label: float(neutral[column]) for column, label in columns.items()}, "V = 0")
    right.set(ylim=(0.0, 1.05), ylabel="survival of pushes")
    legend(figure, left)
    return figure


def race(rows: Rows) -> Figure:
    """Final scores with their standard errors, and how many trainings are at 95 % of the best, finally or before."""
    labels = [row["algorithm"] for row in rows]
    figure, (left, right) = panels(2, 0.4, sharey=True)
    scores, errors = numbers(rows, "final_score"), numbers(rows, "final_score_error")
    ends = [[score + sign * error for score, error in zip(scores, errors, strict=True)] for sign in (-1, 1)]
    draw_intervals(left, labels, scores, *ends)
    left.set_xlabel("final score, mean and standard error")
    heights = range(len(labels), 0, -1)
    right.hlines(heights, numbers(rows, "final_at_95_low"), numbers(rows, "final_at_95_high"), color=COLOURS[0])
    named = (("final_at_95", "o", COLOURS[0], "final score"), ("held_95", "s", COLOURS[1], "held along the way"))
    for column, marker, colour, label in named:
        right.plot(numbers(rows, column), heights, marker, color=colour, markersize=4, label=label)
    right.xaxis.set_major_locator(MaxNLocator(integer=True))
    right.set(xlabel="trainings at 95 % of the best score", xlim=(-0.5, max(numbers(rows, "runs")) + 0.5))
    legend(figure, right)
    return figure


def standard_task(rows: Rows) -> Figure:
    """Median return, from the lowest seed to the highest."""
    figure, (axis,) = panels(1, 0.25)
    ends = [numbers(rows, f"{which}_return") for which in ("median", "lowest", "highest")]
    draw_intervals(axis, [f"{row['algorithm']}, {row['seeds']} seeds" for row in rows], *ends)
    axis.set_xlabel(f"return on {rows[0]['task']} after {rows[0]['steps']} steps: median, lowest and highest seed")
    return figure


def learning_curves(rows: Rows, panel: str) -> Figure:
    """Return along the training, median and lowest to highest seed, a panel for each group of rows."""
    groups = grouped(rows, panel)
    figure, axes = panels(len(groups), 0.35)
    for axis, (name, group) in zip(axes, groups.items(), strict=True):
        draw_lines(axis, group, "steps", "return", "{algorithm}", rows)
        axis.set_title(name, fontsize="small")
        axis.set_ylabel("return" if axis is axes[0] else "")
        axis.xaxis.set_major_formatter(EngFormatter(sep=""))
    legend(figure, axes[0])
    return figure


def known_truth(rows: Rows) -> Figure:
    """Largest V over its bound by variant of NAF, a panel for each task."""
    tasks = grouped(chosen(rows, "variant!=DDPG"), "{task}")
    figure, axes = panels(len(tasks), 0.35, sharey=True, sharex=True)
    for axis, (name, group) in zip(axes, tasks.items(), strict=True):
        heights = range(len(group), 0, -1)
        axis.plot(numbers(group, "largest_v_over_bound"), heights, "o", color=COLOURS[0], markersize=4)
        axis.axvline(1.0, color="grey", linewidth=0.8)
        axis.set_yticks(heights, [row["variant"] for row in group])
        axis.set_title(name.replace(", ", "\n"), fontsize="small")
        axis.set(xscale="log")
    figure.supxlabel("largest V over its bound", fontsize="medium")
    return figure


def naf_preset(rows: Rows) -> Figure:
    """Score of mu: median and lowest seed."""
    figure, (axis,) = panels(1, 0.55)
    middle = numbers(rows, "mu_median_score")
    draw_intervals(axis, [row["variant"] for row in rows], middle, numbers(rows, "mu_lowest_score"), middle)
    axis.set_xlabel("score of the agent's own action: median of the seeds, and down to the lowest")
    return figure


def robustness(rows: Rows) -> Figure:
    """Survival by force, from the sides and from front and back."""
    figure, axes = panels(2, 0.4, sharey=True)
    directions = grouped(chosen(rows, "direction!=all"), "{direction}")
    for axis, (direction, group) in zip(axes, directions.items(), strict=True):
        draw_lines(axis, group, "push_n", "survival", "{controller}")
        axis.set_title(f"{direction} pushes")
    axes[1].set_ylabel("")
    legend(figure, axes[0])
    return figure


def pushes(rows: Rows, situation: str) -> Figure:
    """Survival of pushes by each controller, a panel for each engine.

    :param rows: rows of the result
    :param situation: column of the situations
    """
    engines = grouped(chosen(rows, "push_n>0 and physics=standard"), "{engine}")
    figure, axes = panels(len(engines), 0.4, sharey=True)
    names = list(
        dict.fromkeys(row[situation] for group in engines.values() for row in group)
    )  # some have one controller
    for axis, (name, group) in zip(axes, engines.items(), strict=True):
        for index, (hips, judged) in enumerate(grouped(group, "{hips}").items()):
            heights = [len(names) - names.index(row[situation]) - 0.2 * index for row in judged]
            axis.hlines(
                heights, numbers(judged, "survival_low"), numbers(judged, "survival_high"), color=COLOURS[index]
            )
            axis.plot(numbers(judged, "survival"), heights, "o", color=COLOURS[index], markersize=4, label=hips)
        axis.set_yticks(range(len(names), 0, -1), names)
        axis.set(title=name, xlabel=heading("survival"))
    legend(figure, axes[0])
    return figure


def landscape(rows: Rows) -> Figure:
    """Score along each parameter, in both engines."""
    parameters = grouped(rows, "{parameter}")
    figure, axes = panels(len(parameters), 0.28, sharey=True)
    for axis, (name, group) in zip(axes, parameters.items(), strict=True):
        draw_lines(axis, group, "value", "score", "{engine}")
        axis.set(xlabel=name, ylabel="score" if axis is axes[0] else "")
    legend(figure, axes[0])
    return figure


def physics(rows: Rows) -> Figure:
    """Score at each setting against the score at the finest, of each set in each condition."""
    condition = "{parameters}, {control_rate_hz}, {sensors}"
    finest = {condition.format(**row): row["score"] for row in rows if not row["difference"]}
    coarser = [{**row, "finest_score": finest[condition.format(**row)]} for row in rows if row["difference"]]
    settings = grouped(coarser, "{setting}")
    figure, axes = panels(len(settings), 0.35, sharey=True)
    for axis, (name, group) in zip(axes, settings.items(), strict=True):
        draw_against(axis, group, "finest_score", "score", "{sensors}")
        axis.set_title(name, fontsize="small")
        axis.set(xlabel="score at the finest", ylabel="score" if axis is axes[0] else "")
    legend(figure, axes[0])
    return figure


def between_engines(label: str) -> Callable[[Rows], Figure]:
    """Score in MuJoCo against score in PyBullet.

    :param label: template that names the groups
    """

    def drawn(rows: Rows) -> Figure:
        figure, axis = plt.subplots(figsize=(1.2 * COLUMN_WIDTH, 1.1 * COLUMN_WIDTH), layout="constrained")
        draw_against(axis, rows, "pybullet_score", "mujoco_score", label)
        scores = [score for engine in ("pybullet", "mujoco") for score in numbers(rows, f"{engine}_score")]
        limits = (min(scores) - 0.05, max(scores) + 0.05)
        axis.set(xlim=limits, ylim=limits)
        figure.legend(*axis.get_legend_handles_labels(), loc="outside upper center", ncols=2)
        return figure

    return drawn


def clock(rows: Rows) -> Figure:
    """How many random sets score above 0.5, and how many of these by a clock."""
    figure, (axis,) = panels(1, 0.2)
    heights = range(len(rows))
    axis.barh(heights, numbers(rows, "sets_above_half"), color=COLOURS[0], label="random sets that score above 0.5")
    axis.barh(heights, numbers(rows, "clocks_above_half"), color=COLOURS[1], label="of these, clocks")
    axis.set_yticks(heights, [f"time-outs of {row['time_out_s']} s" for row in rows])
    legend(figure, axis)
    return figure


def robot_dimensions(rows: Rows) -> Figure:
    """Survival of each robot."""
    figure, axes = panels(2, 0.5, sharey=True)
    for axis, column in zip(axes, ("lateral_survival", "sagittal_survival"), strict=True):
        for colour, (name, group) in zip(COLOURS, grouped(rows, "V = {V}").items(), strict=False):
            heights = range(len(group), 0, -1)
            axis.plot(numbers(group, column), heights, "o", color=colour, markersize=4, alpha=0.8, label=name)
            axis.set_yticks(heights, [row["robot"] for row in group])
        axis.set_xlabel(heading(column))
    legend(figure, axes[0])
    return figure


def updates(rows: Rows) -> Figure:
    """Updates per second of NAF and TD3."""
    figure, (axis,) = panels(1, 0.3)
    for offset, algorithm, colour in ((-0.2, "naf", COLOURS[0]), (0.2, "td3", COLOURS[1])):
        places = [index + offset for index in range(len(rows))]
        axis.bar(places, numbers(rows, f"{algorithm}_updates_per_second"), 0.38, color=colour, label=algorithm.upper())
    labels = [f"{row['layers']}\n{row['observations']} → {row['actions']}" for row in rows]
    axis.set_xticks(range(len(rows)), labels)
    axis.set_ylabel("updates per second")
    legend(figure, axis)
    return figure


PICTURES: dict[str, tuple[tuple[str, ...], Callable[[Rows], Figure]]] = {
    "second_training": (("second_training",), second_training),
    "race_stepping": (("race_stepping",), race),
    "race_balance": (("race_balance",), race),
    "naf_pendulum": (("naf_pendulum",), standard_task),
    "naf_inverted_pendulum": (("naf_inverted_pendulum",), standard_task),
    "several_actions": (("several_actions",), partial(learning_curves, panel="{task}")),
    "known_truth": (("known_truth",), known_truth),
    "naf_preset": (("naf_preset",), naf_preset),
    "robustness": (("robustness",), robustness),
    "conditions": (("conditions",), partial(pushes, situation="situation")),
    "rough_ground": (("rough_ground",), partial(pushes, situation="ground")),
    "landscape_stepping": (("landscape_stepping",), landscape),
    "landscape_balance": (("landscape_balance",), landscape),
    "physics": (("physics",), physics),
    "engines": (("engines",), between_engines("{task}")),
    "transfer": (("transfer_stepping", "transfer_balance"), between_engines("{task}, learned in {learned_in}")),
    "clock": (("clock",), clock),
    "robot_dimensions": (("robot_dimensions",), robot_dimensions),
    "updates": (("updates",), updates),
}
"""Results of each picture, and what draws their rows."""


def draw(name: str, folder: Path) -> tuple[Path, tuple[str, ...]]:
    """Draw a picture.

    :param name: one of :data:`PICTURES`
    :param folder: folder of the file
    :return: the file and the results that it was drawn from
    :raises KeyError: for a name without a picture
    """
    sources, drawn = PICTURES[name]
    path = folder / f"{name}.svg"
    with plt.rc_context(STYLE):
        figure = drawn([row for source in sources for row in record.read(source).rows])
        figure.savefig(path)
        plt.close(figure)
    return path, sources
