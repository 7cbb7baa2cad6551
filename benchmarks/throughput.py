"""How fast episodes are simulated, and where the time goes; figures of one run, as ratios.

The closed loop (sensing, pattern generator, reward, result) against bare physics steps on the same trajectory, and
these steps with PyBullet's answers, of which nothing is made, against the same; the standard physics against the
reference and against 500 Hz with 30 iterations; a training with two workers against one, and against two processes
that know nothing of each other; and the learner's share of a training's time.
"""

from __future__ import annotations

import argparse
import json
import pickle
import subprocess
import sys
import tempfile
import time
from contextlib import closing
from pathlib import Path
from statistics import median
from typing import Any

from stable_baselines3.common.off_policy_algorithm import OffPolicyAlgorithm

from sarah.control.pattern_generator import STAND_SECONDS, Phase
from sarah.envs.episode_vec_env import EpisodeVecEnv
from sarah.episode.episode import Episode
from sarah.episode.spec import TRAINED_STEPPING, EpisodeConfig, EpisodeSpec
from sarah.episode.tasks import STEPPING
from sarah.episode.workers import Workers
from sarah.runs.config import TrainingConfig
from sarah.runs.run_folder import RunFolder
from sarah.simulation.physics import PHYSICS, Physics
from sarah.simulation.pybullet_client import pybullet
from sarah.training.train import train

FORMER_START = Physics(500, 30, added_plate_inertia=0.0)
"""What most prototypes of this robot ran at."""


def started(physics: Physics, limit: float) -> Episode:
    """An episode that has stood for its second; the caller closes it."""
    episode = Episode(EpisodeConfig(physics, time_limit=limit), seed=0)
    episode.stand()
    episode.start(TRAINED_STEPPING)
    return episode


def commands(physics: Physics, limit: float) -> list[tuple[tuple[float, ...], bool]]:
    """What the pattern generator commands at every tick, and whether a foot's height is measured."""
    ticks = []
    with closing(started(physics, limit)) as episode:
        while episode.termination is None:
            swings = episode.generator.phase in (Phase.LIFT, Phase.LAND)
            episode.tick()
            ticks.append((episode.generator.targets, swings))
    return ticks


def closed_loop(physics: Physics, limit: float) -> float:
    """Simulated seconds per second of an episode's ticks."""
    with closing(started(physics, limit)) as episode:
        start = time.perf_counter()
        while episode.termination is None:
            episode.tick()
        simulated = episode.result().duration - STAND_SECONDS
        return simulated / (time.perf_counter() - start)


def bare_loop(physics: Physics, limit: float, ticks: list[tuple[tuple[float, ...], bool]], read: bool = False) -> float:
    """Simulated seconds per second of physics steps alone, on the trajectory of the same targets.

    With ``read`` PyBullet is also asked for what the ticks need, and nothing is made of its answers.
    """
    with closing(started(physics, limit)) as episode:
        simulation, client = episode.simulation, episode.simulation._client
        body, joints = simulation._body, simulation._joints
        foot, _ = simulation._feet["left"]
        start = time.perf_counter()
        for targets, swings in ticks:
            simulation.set_targets(targets)
            pybullet.stepSimulation(physicsClientId=client)
            if read:
                pybullet.getBasePositionAndOrientation(body, physicsClientId=client)
                pybullet.getBaseVelocity(body, physicsClientId=client)
                pybullet.getJointStates(body, joints, client)
                pybullet.getContactPoints(body, body, physicsClientId=client)
                if swings:
                    pybullet.getLinkStates(body, foot, computeForwardKinematics=1, physicsClientId=client)
        return len(ticks) * physics.control_dt / (time.perf_counter() - start)


def loops(limit: float, rounds: int) -> dict[str, float]:
    """Every round measures everything once; ratios are medians of the rounds' ratios."""
    standard, reference = Physics(), PHYSICS["reference"]
    ticks, reference_ticks = commands(standard, limit), commands(reference, limit)
    former_ticks = commands(FORMER_START, limit)
    measured = [
        {
            "closed": closed_loop(standard, limit),
            "bare": bare_loop(standard, limit, ticks),
            "read": bare_loop(standard, limit, ticks, read=True),
            "reference": closed_loop(reference, limit),
            "bare_reference": bare_loop(reference, limit, reference_ticks),
            "former": closed_loop(FORMER_START, limit),
            "bare_former": bare_loop(FORMER_START, limit, former_ticks),
        }
        for _ in range(rounds)
    ]

    def ratio(upper: str, lower: str) -> float:
        return median(one[upper] / one[lower] for one in measured)

    return {
        "closed_loop_times_real_time": median(one["closed"] for one in measured),
        "bare_times_real_time": median(one["bare"] for one in measured),
        "reference_times_real_time": median(one["reference"] for one in measured),
        "closed_loop_over_bare": ratio("closed", "bare"),
        "calls_alone_over_bare": ratio("read", "bare"),
        "closed_loop_over_bare_at_500_hz_30_iterations": ratio("former", "bare_former"),
        "closed_loop_over_bare_at_reference": ratio("reference", "bare_reference"),
        "default_over_reference": ratio("closed", "reference"),
        "default_over_500_hz_30_iterations": ratio("closed", "former"),
    }


def training_seconds(config: TrainingConfig, workers: Workers, folder: Path) -> tuple[float, float]:
    """Seconds of a training from its first step to its last, and how many of them the learner took."""
    total = waited = 0.0
    learn, wait = OffPolicyAlgorithm.learn, EpisodeVecEnv.step_wait

    def timed_wait(env: EpisodeVecEnv) -> Any:
        nonlocal waited
        start = time.perf_counter()
        try:
            return wait(env)
        finally:
            waited += time.perf_counter() - start

    def timed_learn(model: Any, *arguments: Any, **named: Any) -> Any:
        nonlocal total
        start = time.perf_counter()
        try:
            return learn(model, *arguments, **named)
        finally:
            total += time.perf_counter() - start

    EpisodeVecEnv.step_wait = timed_wait  # type: ignore[method-assign]
    OffPolicyAlgorithm.learn = timed_learn  # type: ignore[method-assign]
    try:
        train(config, RunFolder.create(folder, config), workers)
    finally:
        EpisodeVecEnv.step_wait = wait  # type: ignore[method-assign]
        OffPolicyAlgorithm.learn = learn  # type: ignore[method-assign]
    return total, total - waited


def independent_processes(specs: list[EpisodeSpec], folder: Path) -> float:
    """Seconds that two processes take for half of the episodes each, without their start."""
    code = (
        "import pickle, sys, time; from sarah.episode import simulate; specs = pickle.load(open(sys.argv[1], 'rb'));"
        "simulate(specs[0]); start = time.perf_counter(); [simulate(spec) for spec in specs];"
        "print(time.perf_counter() - start)"
    )
    children = []
    for index in range(2):
        file = folder / f"specs{index}.pickle"
        file.write_bytes(pickle.dumps(specs[index::2]))
        children.append(subprocess.Popen([sys.executable, "-c", code, str(file)], stdout=subprocess.PIPE, text=True))
    return max(float(child.communicate()[0]) for child in children)


def trainings(simulations: int, seed: int, folder: Path) -> dict[str, float]:
    """The same training with one worker and with two, and its episodes without learner or scheduler."""
    config = TrainingConfig(simulations=simulations, seed=seed)
    taken, share = {}, 0.0
    for count in (1, 2):
        with Workers(count) as workers:
            list(workers.simulate_all([EpisodeSpec(TRAINED_STEPPING, seed) for seed in range(2 * count)]))  # warm up
            taken[count], learner = training_seconds(config, workers, folder / f"workers-{count}")
            share = learner / taken[count]
    specs = []
    for row in RunFolder(folder / "workers-1").episodes():
        specs.append(EpisodeSpec(tuple(float(row[name]) for name in STEPPING.parameter_names), int(row["seed"])))
    independent = independent_processes(specs, folder)
    return {
        "episodes_per_second_1_worker": len(specs) / taken[1],
        "episodes_per_second_2_workers": len(specs) / taken[2],
        "two_workers_over_one": taken[1] / taken[2],
        "two_workers_over_independent_processes": independent / taken[2],
        "learner_share": share,
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    parser.add_argument("--rounds", type=int, default=5, help="of the loops")
    parser.add_argument("--seconds", type=float, default=11.0, help="of each loop's episode")
    parser.add_argument("--trainings", type=int, default=3, help="of different seeds; figures are their medians")
    parser.add_argument(
        "--simulations", type=int, default=99, help="of each training; below 100, which has no closing comparison"
    )
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        rounds = [trainings(options.simulations, seed, Path(folder, str(seed))) for seed in range(options.trainings)]
    figures = loops(options.seconds, options.rounds)
    figures |= {name: median(one[name] for one in rounds) for name in rounds[0]}
    if options.json:
        print(json.dumps(figures))
        return
    for name, value in figures.items():
        print(f"{name:42}{value:8.3f}")


if __name__ == "__main__":
    main()
