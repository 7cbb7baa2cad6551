"""Who simulates changes nothing: the same in this process, on workers that die, and on a cluster."""

import contextlib
import os
import shutil
import signal
import subprocess
import sys
import threading
import time
import zipfile
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import distributed
import pytest
from laboratory import COARSE_PHYSICS

from sarah import EpisodeConfig, EpisodeSpec, SensorReading
from sarah.control.parameters import PAPER_STEPPING
from sarah.episode import cluster as cluster_module
from sarah.episode import workers as workers_module
from sarah.episode.episode import Episode, simulate
from sarah.episode.workers import Workers, begin_episode, finish_episode
from sarah.errors import WorkersError
from sarah.runs.config import TrainingConfig
from sarah.runs.run_folder import RunFolder
from sarah.training.train import train
from sarah.versions import source_hash

# Longer than the 8 simulations of warm-up; a quarter of the episodes end early, as robots fall.
COARSE = EpisodeConfig(time_limit=3.0, physics=COARSE_PHYSICS)
TRAINING = TrainingConfig(episodes=20, slots=4, seed=5, episode=COARSE)
SPEC = EpisodeSpec(PAPER_STEPPING, seed=1, config=EpisodeConfig(time_limit=1.5, physics=COARSE_PHYSICS))


def train_in(folder: Path, workers: Workers | None) -> RunFolder:
    run_folder = RunFolder.create(folder, TRAINING)
    train(TRAINING, run_folder, workers)
    return run_folder


def learned_bytes(run_folder: RunFolder) -> dict[str, bytes]:
    weights = zipfile.ZipFile(run_folder.model_path).read("policy.pth")
    texts = {name: (run_folder.path / name).read_bytes() for name in ("episodes.csv", "parameters.json")}
    return {**texts, "weights": weights}


@pytest.fixture
def stood(monkeypatch: pytest.MonkeyPatch) -> Any:
    """All episodes of this process that stood in a test, and those of them that are still open."""
    workers_module.close_waiting_episodes()
    seen = SimpleNamespace(all=[], open=[])

    class Seen(Episode):
        def stand(self) -> SensorReading:
            seen.all.append(self)
            seen.open.append(self)
            return super().stand()

        def close(self) -> None:
            seen.open.remove(self)
            super().close()

    monkeypatch.setattr(workers_module, "Episode", Seen)
    return seen


def test_training_survives_the_death_of_workers(workers: Workers, tmp_path: Path) -> None:
    killed: list[int] = []
    run = tmp_path / "survives"

    def kill_when_rows(counts: list[int]) -> None:
        for count in counts:
            while not (run / "episodes.csv").exists() or len(list(RunFolder(run).episodes())) < count:
                time.sleep(0.01)
            assert workers.client is not None
            pids: list[int] = []
            while not pids:  # while they all restart
                pids = list(workers.client.run(os.getpid, on_error="ignore").values())
            os.kill(pids[0], signal.SIGKILL)
            killed.append(pids[0])

    killer = threading.Thread(target=kill_when_rows, args=([2, 10],), daemon=True)
    killer.start()
    survived = learned_bytes(train_in(run, workers))
    killer.join(timeout=30.0)
    assert len(set(killed)) == 2
    assert survived == learned_bytes(train_in(tmp_path / "alone", None))


@pytest.fixture(scope="module")
def scheduler() -> Iterator[str]:
    """Address of a scheduler as on a cluster, without workers."""
    with distributed.LocalCluster(n_workers=0, dashboard_address=None) as cluster:
        yield cluster.scheduler_address


@contextlib.contextmanager
def worker(scheduler: str, folder: Path, **path: str) -> Iterator[None]:
    """A worker of the scheduler, perhaps with a ``PYTHONPATH`` of its own."""
    command = [sys.executable, "-m", "dask", "worker", scheduler, "--nthreads", "1", "--no-nanny", "--no-dashboard"]
    process = subprocess.Popen(command, stderr=subprocess.DEVNULL, cwd=folder, env={**os.environ, **path})
    try:
        with distributed.Client(scheduler) as client:
            client.wait_for_workers(1, timeout=60)
            yield
            process.kill()
            while client.nthreads():  # the scheduler has not noticed yet
                time.sleep(0.1)
    finally:
        process.kill()
        process.wait(timeout=30)


def test_a_cluster_gives_the_same(scheduler: str, tmp_path: Path) -> None:
    with worker(scheduler, tmp_path), Workers(scheduler=scheduler) as workers:
        assert list(workers.simulate_all([SPEC])) == [simulate(SPEC)]


def test_a_worker_with_other_code_is_refused_whenever_it_comes(scheduler: str, tmp_path: Path) -> None:
    package = Path(cluster_module.__file__).parents[1]
    copied = shutil.copytree(package, tmp_path / "other" / "sarah", ignore=shutil.ignore_patterns("__pycache__"))
    with (copied / "episode" / "reward.py").open("a") as reward:
        reward.write("# another state\n")
    refused = rf"worker tcp://127.0.0.1:\d+ is refused, .*: sarah-sources is {source_hash()} here, and \w{{12}} there"
    with Workers(scheduler=scheduler) as workers, worker(scheduler, tmp_path, PYTHONPATH=str(copied.parent)):
        with pytest.raises(WorkersError, match=refused):
            next(workers.simulate_all([SPEC]))
        with pytest.raises(WorkersError, match=refused):
            train_in(tmp_path / "run", workers)
        assert not list(RunFolder(tmp_path / "run").episodes())
        with pytest.raises(WorkersError, match=refused):
            Workers(scheduler=scheduler).__enter__()


def test_a_worker_without_this_package_is_refused(scheduler: str, tmp_path: Path) -> None:
    (tmp_path / "sarah.py").write_text("raise ModuleNotFoundError(\"No module named 'sarah'\")\n")
    with (
        worker(scheduler, tmp_path, PYTHONPATH=str(tmp_path)),
        pytest.raises(WorkersError, match=r"tells no versions: .*No module named 'sarah'"),
    ):
        Workers(scheduler=scheduler).__enter__()


def test_an_episode_continues_where_it_stands_or_begins_anew(stood: Any) -> None:
    following, expected = EpisodeSpec(SPEC.parameters, 2, config=SPEC.config), simulate(SPEC)
    begin_episode(SPEC)
    assert len(stood.open) == 1
    assert finish_episode(SPEC).result == expected
    assert len(stood.all) == 1 and not stood.open
    outcome = finish_episode(SPEC, following)  # it stands nowhere, and lets the following one stand
    assert outcome.result == expected and len(stood.all) == 3 and len(stood.open) == 1
    assert finish_episode(following).result == simulate(following)
    assert len(stood.all) == 3 and not stood.open
    assert outcome.following == begin_episode(following)


def test_waiting_episodes_are_bounded_and_forgotten(stood: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(workers_module, "MOST_WAITING", 2)
    with Workers():
        for _ in range(4):
            begin_episode(SPEC)
        assert len(stood.open) == 1  # who stands twice keeps one world
        for seed in range(4):
            begin_episode(EpisodeSpec(SPEC.parameters, seed, config=SPEC.config))
        assert len(stood.open) == 2
    assert not stood.open
