"""A training that several tests look at."""

import pytest

from sarah.episode.episode import simulate
from sarah.episode.push import Push
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import BALANCE, BalanceConfig
from sarah.runs.config import TrainingConfig
from sarah.runs.run_folder import RunFolder

CONFIG = BalanceConfig(time_limit=6.0, push=Push(newtons=(40.0, 60.0), at_seconds=(2.0, 3.0)))
TRIED = ((0.0, 0.0, 0.0, 0.0), (1.0, 0.0, 0.5, 0.0), (-2.0, 1.0, 0.0, 2.0))
LEARNED = (0.8, 0.1, 0.3, -0.1)


@pytest.fixture(scope="session")
def run(tmp_path_factory: pytest.TempPathFactory) -> RunFolder:
    path = tmp_path_factory.mktemp("runs") / "balance"
    run = RunFolder.create(path, TrainingConfig(task="balance", episodes=3, episode=CONFIG))
    for index, parameters in enumerate(TRIED):
        spec = EpisodeSpec(parameters, 2**31 + index, "balance", CONFIG)
        result = simulate(spec)
        run.append_episode(index, spec, result)
    run.write_parameters({"parameters": dict(zip(BALANCE.parameter_names, LEARNED, strict=True))})
    return run
