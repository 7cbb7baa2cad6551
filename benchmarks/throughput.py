"""How fast are episodes simulated, and where does the time go?

Timed are the closed loop (sensing, pattern generator, reward, result) against bare physics steps on the same
trajectory, and these steps with PyBullet's answers, of which nothing is made, against the same; the standard physics
against the reference and against 500 Hz with 30 iterations; a training with two workers against one, and against two
processes that know nothing of each other; and the learner's share of a training's time. A second run of all shows how
far such figures repeat.
"""

from __future__ import annotations

import pickle
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from typing import Any

from pandas import DataFrame

from benchmarks.timing import Timing
from experiments.experiment import TRAINING
from experiments.record import Row
from experiments.tables import turned_table
from sarah.control.pattern_generator import STAND_SECONDS, Phase
from sarah.episode.episode import Episode, simulate
from sarah.episode.settings import EpisodeConfig
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks.balance import TRAINED_STEPPING
from sarah.episode.workers import Executor, Job, Workers, finish_episode
from sarah.robot.description import PLATES
from sarah.robot.reading import ACTUATED_JOINTS, Side
from sarah.runs.config import TrainingConfig
from sarah.runs.run_folder import RunFolder
from sarah.simulation.physics import PHYSICS, PyBulletPhysics
from sarah.simulation.pybullet_simulator import PyBulletSimulator
from sarah.simulation.pybullet_world import pybullet
from sarah.training.train import train

STANDARD, REFERENCE = PyBulletPhysics(), PHYSICS["reference"]
FINER = PyBulletPhysics(500, 30, added_plate_inertia=0.0)
"""A setting without added inertia, between standard and reference."""


@dataclass(frozen=True)
class Throughput(Timing):
    """Speeds of episodes and of a training in PyBullet, and their ratios.

    :param rounds: number of rounds, each of which measures every loop once; ratios are medians of the rounds'
    :param loop_seconds: time limit of a loop's episode, in s
    :param budget: number of episodes of the training; below 25 there are no trials of its recommendation
    :param time_limit: time limit of the training's episodes, in s
    """

    depends_on = TRAINING
    rounds: int = 5
    loop_seconds: float = 11.0
    budget: int = 100
    time_limit: float = 30.0

    def cases(self) -> list[Row]:
        """Two runs of all."""
        return [{"run": "first run"}, {"run": "second run"}]

    def rows(self, run: str) -> Iterator[Row]:
        """A row for each quantity.

        :param run: name of the run
        """
        with tempfile.TemporaryDirectory() as folder:
            measured = self._loops() | self._training(Path(folder))
        yield from ({"quantity": quantity, "value": value} for quantity, value in measured.items())

    def _loops(self) -> dict[str, float]:
        ticks = {physics: commands(physics, self.loop_seconds) for physics in (STANDARD, REFERENCE, FINER)}
        rounds = []
        for _ in range(self.rounds):
            speeds = {("closed", physics): closed_loop(physics, self.loop_seconds) for physics in ticks}
            speeds |= {("bare", physics): bare_loop(physics, self.loop_seconds, ticks[physics]) for physics in ticks}
            speeds["read", STANDARD] = bare_loop(STANDARD, self.loop_seconds, ticks[STANDARD], read=True)
            rounds.append(speeds)

        def ratio(upper: tuple[str, PyBulletPhysics], lower: tuple[str, PyBulletPhysics]) -> float:
            return median(speeds[upper] / speeds[lower] for speeds in rounds)

        closed, bare = ("closed", STANDARD), ("bare", STANDARD)
        return {
            "closed loop of an episode: seconds simulated per second": median(speeds[closed] for speeds in rounds),
            "bare physics steps of the same trajectory: seconds simulated per second": median(
                speeds[bare] for speeds in rounds
            ),
            "closed loop over bare physics steps": ratio(closed, bare),
            "closed loop over bare physics steps at 500 Hz with 30 iterations": ratio(
                ("closed", FINER), ("bare", FINER)
            ),
            "closed loop over bare physics steps at the reference physics": ratio(
                ("closed", REFERENCE), ("bare", REFERENCE)
            ),
            "bare physics steps with PyBullet's answers over those without": ratio(("read", STANDARD), bare),
            "standard physics over reference physics": ratio(closed, ("closed", REFERENCE)),
            "standard physics over 500 Hz with 30 iterations": ratio(closed, ("closed", FINER)),
        }

    def _training(self, folder: Path) -> dict[str, float]:
        """The same training with one worker and with two, and its episodes without learner or scheduler."""
        episode = EpisodeConfig(engine="pybullet", time_limit=self.time_limit)
        config = TrainingConfig(episodes=self.budget, episode=episode)
        taken, share = {}, 0.0
        for count in (1, 2):
            with Workers(count) as workers:
                list(
                    workers.simulate_all([EpisodeSpec(TRAINED_STEPPING, seed) for seed in range(2 * count)])
                )  # warm up
                watched = Watched(workers)
                start = time.perf_counter()
                train(config, RunFolder.create(folder / f"workers-{count}", config), watched)
                taken[count] = time.perf_counter() - start
                share = 1.0 - watched.waited / taken[count]
        episodes = len(watched.specs)
        return {
            "episodes per second of a training, one worker": episodes / taken[1],
            "episodes per second of a training, two workers": episodes / taken[2],
            "two workers over one": taken[1] / taken[2],
            "two workers over two processes without a learner": seconds_without_learner(watched.specs, folder)
            / taken[2],
            "learner's share of a training's time": share,
        }


class Watched(Executor):
    """Notes which episodes are simulated, and how long a training waits for them.

    :param workers: who simulates
    """

    def __init__(self, workers: Workers) -> None:
        self.specs: list[EpisodeSpec] = []
        self.waited = 0.0
        self._workers = workers

    def submit(self, function: Callable[..., Any], *subjects: Any) -> Job:
        """Have something done.

        :param function: what is done
        :param subjects: of the function, the specification of an episode first
        """
        if function in (simulate, finish_episode):
            self.specs.append(subjects[0])
        return Job(WatchedJob(self, self._workers.submit(function, *subjects)).result)


@dataclass(frozen=True)
class WatchedJob:
    """Something that a training waits for.

    :param watched: who notes how long
    :param job: what is waited for
    """

    watched: Watched
    job: Job

    def result(self) -> Any:
        """What came of it."""
        start = time.perf_counter()
        try:
            return self.job.result()
        finally:
            self.watched.waited += time.perf_counter() - start


Tick = tuple[tuple[float, ...], bool]
"""Targets of the joints, and whether a foot's height is measured."""


def started(physics: PyBulletPhysics, limit: float) -> Episode:
    """An episode that has stood for its second; the caller closes it.

    :param physics: setting of the physics
    :param limit: time limit, in s
    """
    episode = Episode(EpisodeConfig(physics, "pybullet", time_limit=limit), seed=0)
    episode.stand()
    episode.start(TRAINED_STEPPING)
    return episode


def commands(physics: PyBulletPhysics, limit: float) -> list[Tick]:
    """What the pattern generator commands at every tick.

    :param physics: setting of the physics
    :param limit: time limit, in s
    """
    ticks: list[Tick] = []
    with started(physics, limit) as episode:
        while episode.termination is None:
            swings = episode.robot.generator.phase in (Phase.LIFT, Phase.LAND)
            episode.tick()
            ticks.append((episode.robot.generator.targets, swings))
    return ticks


def closed_loop(physics: PyBulletPhysics, limit: float) -> float:
    """Simulated seconds per second of an episode's ticks.

    :param physics: setting of the physics
    :param limit: time limit, in s
    """
    with started(physics, limit) as episode:
        start = time.perf_counter()
        while episode.termination is None:
            episode.tick()
        simulated = episode.result().duration - STAND_SECONDS
        return simulated / (time.perf_counter() - start)


def bare_loop(physics: PyBulletPhysics, limit: float, ticks: list[Tick], read: bool = False) -> float:
    """Simulated seconds per second of physics steps alone, on the trajectory of the same targets.

    :param physics: setting of the physics
    :param limit: time limit, in s
    :param ticks: what is commanded
    :param read: whether PyBullet is also asked for what the ticks need, of which nothing is made
    """
    with started(physics, limit) as episode:
        simulation = episode.robot.simulation
        assert isinstance(simulation, PyBulletSimulator)
        client, body = simulation.client, simulation.body
        joints = [simulation.links[name] for name in ACTUATED_JOINTS]
        foot = [simulation.links[f"{Side.LEFT}_{plate}"] for plate in PLATES]
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


def seconds_without_learner(specs: list[EpisodeSpec], folder: Path) -> float:
    """Seconds that two processes take for half of the episodes each, without their start.

    :param specs: the episodes
    :param folder: folder for files
    """
    code = (
        "import pickle, sys, time; from sarah import simulate; specs = pickle.load(open(sys.argv[1], 'rb'));"
        "simulate(specs[0]); start = time.perf_counter(); [simulate(spec) for spec in specs];"
        "print(time.perf_counter() - start)"
    )
    children = []
    for index in range(2):
        file = folder / f"specs{index}.pickle"
        file.write_bytes(pickle.dumps(specs[index::2]))
        children.append(subprocess.Popen([sys.executable, "-c", code, str(file)], stdout=subprocess.PIPE, text=True))
    return max(float(child.communicate()[0]) for child in children)


FULL = Throughput()
QUICK = Throughput(time_limit=2.0, rounds=1, budget=5)


def speeds(rows: DataFrame) -> str:
    """All quantities, of both runs."""
    caption = "Episodes on two cores of a small virtual machine, in two runs of the same."
    return turned_table(rows, ["quantity"], "run", "value", caption, ".3g")
