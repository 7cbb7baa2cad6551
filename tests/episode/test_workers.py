"""Who simulates changes nothing: the same training in this process, on workers that die, and on a cluster."""

import contextlib
import json
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

import distributed
import psutil
import pytest
from laboratory import COARSE_PHYSICS, NEEDS_PYBULLET

from sarah.control.parameters import PAPER_STEPPING
from sarah.episode import cluster as cluster_module
from sarah.episode import workers as workers_module
from sarah.episode.episode import Episode, simulate
from sarah.episode.settings import EpisodeConfig
from sarah.episode.spec import EpisodeSpec
from sarah.episode.workers import Workers, begin_episode, finish_episode
from sarah.errors import ConfigurationError, WorkersError
from sarah.robot.reading import SensorReading
from sarah.runs.config import TrainingConfig
from sarah.runs.run_folder import RunFolder
from sarah.simulation.pybullet_world import pybullet
from sarah.training.train import train
from sarah.versions import source_hash

# Longer than the 8 simulations of warm-up; a quarter of the episodes end early, as robots fall.
COARSE = EpisodeConfig(time_limit=3.0, physics=COARSE_PHYSICS)
TRAINING = TrainingConfig(episodes=20, slots=4, seed=5, episode=COARSE)
SPEC = EpisodeSpec((0.4, 1.3, 0.1, 1.0, 1.0), seed=1, config=EpisodeConfig(time_limit=2.0))


def train_in(folder: Path, workers: Workers | None) -> RunFolder:
    run_folder = RunFolder.create(folder, TRAINING)
    train(TRAINING, run_folder, workers)
    return run_folder


def learned_bytes(run_folder: RunFolder) -> dict[str, bytes]:
    """What must not depend on who simulated."""
    weights = zipfile.ZipFile(run_folder.model_path).read("policy.pth")
    texts = {name: (run_folder.path / name).read_bytes() for name in ("episodes.csv", "parameters.json")}
    return {**texts, "weights": weights}


class Stood:
    """Episodes of this process that stood, and those of them that are still open."""

    def __init__(self) -> None:
        self.all: list[Episode] = []
        self.open: list[Episode] = []


@pytest.fixture
def stood(monkeypatch: pytest.MonkeyPatch) -> Stood:
    """Those of a test; whatever other tests have left standing is gone."""
    workers_module.close_waiting_episodes()
    seen = Stood()

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


@pytest.fixture(scope="module")
def alone(tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    return learned_bytes(train_in(tmp_path_factory.mktemp("alone"), None))


@pytest.mark.parametrize("count", [1, 3])
def test_training_does_not_depend_on_the_number_of_workers(count: int, alone: dict[str, bytes], tmp_path: Path) -> None:
    with Workers(count) as workers:
        assert learned_bytes(train_in(tmp_path, workers)) == alone


def test_training_survives_the_death_of_workers(alone: dict[str, bytes], tmp_path: Path) -> None:
    killed: list[int] = []

    def kill_when_rows(workers: Workers, counts: list[int]) -> None:
        for count in counts:
            while not (tmp_path / "episodes.csv").exists() or len(list(RunFolder(tmp_path).episodes())) < count:
                time.sleep(0.01)
            assert workers.client is not None
            pids: list[int] = []
            while not pids:  # while they all restart
                pids = list(workers.client.run(os.getpid, on_error="ignore").values())
            pid = pids[0]
            os.kill(pid, signal.SIGKILL)
            killed.append(pid)

    with Workers(2) as workers:
        killer = threading.Thread(target=kill_when_rows, args=(workers, [2, 10]), daemon=True)
        killer.start()
        survived = learned_bytes(train_in(tmp_path, workers))
        killer.join(timeout=30.0)
    assert len(set(killed)) == 2
    assert survived == alone


class Cluster:
    """A scheduler and its workers, started as on a cluster.

    :param folder: folder that they run in
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._file = folder / "scheduler.json"
        self._processes = [self._begin("scheduler", "--host", "127.0.0.1", "--port", "0")]
        while not self._file.exists():
            assert self._processes[0].poll() is None
            time.sleep(0.1)
        self.address = json.loads(self._file.read_text())["address"]

    def add_worker(self, path: str = "") -> None:
        """Start a worker, which finds modules in a folder first."""
        self._processes.append(self._begin("worker", "--nthreads", "1", "--death-timeout", "60", PYTHONPATH=path))

    def _begin(self, *arguments: str, **environment: str) -> subprocess.Popen[bytes]:
        command = [sys.executable, "-m", "dask", *arguments, "--no-dashboard", "--scheduler-file", str(self._file)]
        environment = {name: value for name, value in {**os.environ, **environment}.items() if value}
        return subprocess.Popen(command, stderr=subprocess.DEVNULL, cwd=self.folder, env=environment)

    def stop(self) -> None:
        """Kill all: dask takes eight seconds to leave politely."""
        for process in self._processes:
            with contextlib.suppress(psutil.NoSuchProcess):  # it has ended by itself
                for child in psutil.Process(process.pid).children(recursive=True):
                    child.kill()
            process.kill()
            process.wait(timeout=30)


@pytest.fixture
def cluster(tmp_path: Path) -> Iterator[Cluster]:
    made = Cluster(tmp_path)
    yield made
    made.stop()


def test_training_on_a_cluster_is_the_same(cluster: Cluster, alone: dict[str, bytes], tmp_path: Path) -> None:
    cluster.add_worker()
    cluster.add_worker()
    with Workers(scheduler=cluster.address) as workers:
        assert learned_bytes(train_in(tmp_path / "run", workers)) == alone


@pytest.fixture
def other_code(tmp_path: Path) -> str:
    """A folder with this package in another state of its code, whose version number is the same."""
    package = Path(cluster_module.__file__).parents[1]
    copied = shutil.copytree(package, tmp_path / "other" / "sarah", ignore=shutil.ignore_patterns("__pycache__"))
    reward = copied / "episode" / "reward.py"
    reward.write_text(reward.read_text() + "# another state\n")
    return str(copied.parent)


def test_a_worker_with_other_code_is_refused_whenever_it_comes(
    cluster: Cluster, other_code: str, tmp_path: Path
) -> None:
    refused = rf"worker tcp://127.0.0.1:\d+ is refused, .*: sarah-sources is {source_hash()} here, and \w{{12}} there"
    with Workers(scheduler=cluster.address) as workers:
        cluster.add_worker(other_code)
        with pytest.raises(WorkersError, match=refused):
            next(workers.simulate_all([SPEC]))
        with pytest.raises(WorkersError, match=refused):
            train_in(tmp_path / "run", workers)
        assert not list(RunFolder(tmp_path / "run").episodes())
    with pytest.raises(WorkersError, match=refused), Workers(scheduler=cluster.address):
        pass


def test_a_worker_without_this_package_is_refused(cluster: Cluster, tmp_path: Path) -> None:
    (tmp_path / "none").mkdir()
    (tmp_path / "none" / "sarah.py").write_text("raise ModuleNotFoundError(\"No module named 'sarah'\")\n")
    cluster.add_worker(str(tmp_path / "none"))
    with distributed.Client(cluster.address) as client:
        client.wait_for_workers(1, timeout=30)
    with (
        pytest.raises(WorkersError, match=r"tells no versions: .*No module named 'sarah'"),
        Workers(scheduler=cluster.address),
    ):
        pass


def test_results_come_in_the_order_of_the_specifications() -> None:
    specs = [EpisodeSpec(SPEC.parameters, seed, config=SPEC.config) for seed in range(6)]
    with Workers(2) as workers:
        assert list(workers.simulate_all(specs)) == [simulate(spec) for spec in specs]


def test_an_episode_continues_where_it_stands_or_begins_anew(stood: Stood) -> None:
    expected = simulate(SPEC)
    begin_episode(SPEC)
    assert len(stood.open) == 1
    assert finish_episode(SPEC).result == expected
    assert len(stood.all) == 1 and not stood.open
    assert finish_episode(SPEC).result == expected  # that stands nowhere
    assert len(stood.all) == 2 and not stood.open


def test_who_ran_an_episode_lets_the_following_one_stand(stood: Stood) -> None:
    following = EpisodeSpec(SPEC.parameters, 2, config=SPEC.config)
    outcome = finish_episode(SPEC, following)
    assert outcome.result == simulate(SPEC)
    assert len(stood.open) == 1
    assert finish_episode(following).result == simulate(following)
    assert len(stood.all) == 2 and not stood.open
    assert outcome.following == begin_episode(following)


@NEEDS_PYBULLET
def test_whoever_stands_twice_keeps_one_world(stood: Stood) -> None:
    def worlds() -> int:
        return sum(pybullet.isConnected(client) for client in range(200))

    with Workers():
        begin_episode(SPEC)
        before = worlds()
        for _ in range(4):
            begin_episode(SPEC)
        assert len(stood.open) == 1
        assert worlds() <= before + 1  # two at a time, while one takes the other's place


def test_waiting_episodes_are_bounded_and_forgotten(stood: Stood, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(workers_module, "MOST_WAITING", 2)
    with Workers():
        for seed in range(4):
            begin_episode(EpisodeSpec(SPEC.parameters, seed, config=SPEC.config))
        assert len(stood.open) == 2
    assert not stood.open


def test_workers_listen_to_this_machine_only() -> None:
    with Workers(1):
        here = psutil.Process()
        listening = [
            connection.laddr.ip
            for process in (here, *here.children(recursive=True))
            for connection in process.net_connections()
            if connection.status == psutil.CONN_LISTEN
        ]
    assert listening and set(listening) == {"127.0.0.1"}


def test_bad_workers_are_refused() -> None:
    with pytest.raises(ConfigurationError, match="workers must be between 0 and 256, not -1"):
        Workers(-1)
    with pytest.raises(ConfigurationError, match=r"^workers must be a whole number, not 1\.5$"):
        Workers(1.5)  # type: ignore[arg-type]
    with pytest.raises(ConfigurationError, match="give one of the two"):
        Workers(2, "tcp://127.0.0.1:1")


def test_workers_that_were_not_started_are_refused() -> None:
    for workers in (Workers(2), Workers(scheduler="tcp://127.0.0.1:1")):
        with pytest.raises(ConfigurationError, match="workers start in a with statement"):
            workers.submit(simulate, EpisodeSpec(PAPER_STEPPING, 0))
