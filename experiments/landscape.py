"""What each parameter does: one of P1 to P5 varied around a good set, or one of V1 to V4 under pushes, in each engine.

Prints score and steps per second, or score and survival, and draws the curves if there is an --out.
"""

from __future__ import annotations

import argparse
import os
from itertools import islice
from pathlib import Path
from typing import get_args

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

from sarah.episode.evaluation import Evaluation, summarise
from sarah.episode.push import Push
from sarah.episode.spec import EpisodeConfig, EpisodeSpec
from sarah.episode.tasks import BALANCE, TASKS
from sarah.episode.workers import Workers
from sarah.pictures.style import COLUMN_WIDTH, STYLE
from sarah.reports.transfer_figure import ENGINE_COLOURS
from sarah.simulation.engines import Engine
from sarah.simulation.physics import PHYSICS

CENTRES = {"stepping": (0.4, 1.0, 0.1, 1.0, 1.0), "balance": (1.0, 0.0, 0.0, 0.0)}
VALUES = {
    "stepping": (0.0, 0.2, 0.3, 0.4, 0.5, 0.6, 0.8, 1.0, 1.5, 2.0),
    "balance": (-2.0, -1.0, -0.5, 0.0, 0.5, 1.0, 1.5, 2.0),
}

Curves = dict[str, list[Evaluation]]
"""By parameter: an evaluation for each value."""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--task", choices=TASKS, default="stepping")
    parser.add_argument("--engines", nargs="+", choices=get_args(Engine), default=["pybullet"])
    parser.add_argument("--episodes", type=int, default=1, help="seeds")
    parser.add_argument("--seconds", type=float, default=30.0, help="time limit of an episode")
    parser.add_argument("--newtons", type=float, default=100.0, help="of the pushes")
    parser.add_argument("--physics", choices=PHYSICS, default="standard")
    parser.add_argument("--out", type=Path, help="picture of the curves")
    options = parser.parse_args()
    curves: dict[str, Curves] = {}
    with Workers(os.cpu_count() or 1) as workers:
        for engine in options.engines:
            config = EpisodeConfig(
                engine=engine,
                physics=PHYSICS[options.physics],
                time_limit=options.seconds,
                push=Push(newtons=(options.newtons, options.newtons)),
            )
            curves[engine] = measure(options.task, config, options.episodes, workers)
            show(options.task, engine, options, curves[engine])
    if options.out is not None:
        draw(options.task, curves, options.out)


def measure(task: str, config: EpisodeConfig, episodes: int, workers: Workers) -> Curves:
    centre, names = CENTRES[task], TASKS[task].parameter_names
    specs = [
        EpisodeSpec((*centre[:index], value, *centre[index + 1 :]), seed, task, config)
        for index in range(len(names))
        for value in VALUES[task]
        for seed in range(episodes)
    ]
    results = iter(list(workers.simulate_all(specs)))
    return {name: [summarise(islice(results, episodes)) for _ in VALUES[task]] for name in names}


def show(task: str, engine: str, options: argparse.Namespace, curves: Curves) -> None:
    pushed = task == BALANCE.name
    inside = f"median score (survival of {options.newtons:g} N)" if pushed else "median score (steps per second)"
    print(f"{inside} of {options.episodes} seed(s) around {CENTRES[task]}: {engine}, {options.physics} physics\n")
    print("| value |", " | ".join(curves), "|")
    print("|---" * (len(curves) + 1) + "|")
    for row, value in enumerate(VALUES[task]):
        cells = [
            f"{e[row].score_median:.2f} ({e[row].survival_rate if pushed else e[row].steps_per_second_mean:.1f})"
            for e in curves.values()
        ]
        print(f"| {value:g} |", " | ".join(cells), "|")
    print(flush=True)


def draw(task: str, curves: dict[str, Curves], path: Path) -> None:
    names = TASKS[task].parameter_names
    with plt.rc_context(STYLE):
        figure, axes = plt.subplots(
            1, len(names), figsize=(2 * COLUMN_WIDTH, 0.55 * COLUMN_WIDTH), sharey=True, layout="constrained"
        )
        for axis, name in zip(axes, names, strict=True):
            for engine, curve in curves.items():
                scores = [evaluation.score_mean for evaluation in curve[name]]
                axis.plot(VALUES[task], scores, ".-", color=ENGINE_COLOURS[engine], linewidth=1.0, label=engine)
            axis.set_xlabel(name)
        axes[0].set_ylabel("score")
        figure.legend(*axes[0].get_legend_handles_labels(), loc="outside upper center", ncols=len(curves))
        figure.savefig(path, dpi=200)


if __name__ == "__main__":
    main()
