"""How does NAF do on small tasks whose truth is known, or where a place is to be reached?

NAF, variants of it, DDPG and TD3, with the defaults of their classes but for narrower layers.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
import torch as th
from pandas import DataFrame, Index
from stable_baselines3.common.off_policy_algorithm import OffPolicyAlgorithm

from experiments.experiment import Experiment, product
from experiments.naf.algorithms import EVALUATION_SEED, EXPLORATION_STD, VARIANTS, Watched, agent, mean_return
from experiments.naf.known_truth import KNOWN_TASKS, KnownTask
from experiments.naf.points import POINT_TASKS
from experiments.record import Row
from experiments.tables import shown, table, unique

ON_KNOWN_TASKS = [name for name, variant in VARIANTS.items() if variant.exploration_std == EXPLORATION_STD] + ["DDPG"]
ON_POINT_TASKS = ["NAF", "NAF, no pull to the centre", "DDPG", "TD3"]
LAYERS = [64, 64]
FRESH = 2000
"""Number of the newest transitions on which an agent is judged."""
SATURATED = 0.95
"""Size of an entry of mu from which on it counts as at the bound."""
VALUES = ("v_minus_true", "curvature", "true_curvature", "gap_over_true", "distance_of_mu", "saturated")
COLUMNS = ("score", "return", "v_over_bound", *VALUES)


@dataclass(frozen=True)
class KnownTasks(Experiment):
    """NAF, variants of it, DDPG and TD3 on small tasks.

    :param steps: number of steps of a training whose truth is known
    :param seeds: number of these trainings of each algorithm
    :param episodes: number of evaluation episodes of each
    :param point_steps: number of steps of a training in which a place is to be reached
    :param point_seeds: number of these trainings of each algorithm
    :param point_episodes: number of evaluation episodes of each
    """

    depends_on: ClassVar[tuple[str, ...]] = ("agents",)
    steps: int = 5000
    seeds: int = 5
    episodes: int = 10
    point_steps: int = 4000
    point_seeds: int = 10
    point_episodes: int = 20

    def cases(self) -> list[Row]:
        """Each training."""
        known = product(task=KNOWN_TASKS, algorithm=ON_KNOWN_TASKS, seed=range(self.seeds))
        return known + product(task=POINT_TASKS, algorithm=ON_POINT_TASKS, seed=range(self.point_seeds))

    def rows(self, task: str, algorithm: str, seed: int) -> Iterator[Row]:
        """What an agent has learned."""
        th.set_num_threads(1)
        known = KNOWN_TASKS.get(task)
        env = known(seed) if known else POINT_TASKS[task]()
        steps, settings = (self.steps, {}) if known else (self.point_steps, env.settings)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # that V runs away is what the rows say
            model = agent(algorithm, env, seed, LAYERS, **settings).learn(steps)
        found = dict.fromkeys(COLUMNS) | {"v_over_bound": getattr(model, "highest_ratio", None)}
        if known:
            found |= {"score": _score(known, model, self.episodes), **_beside_truth(model, env)}
        else:
            found["return"] = mean_return(model, POINT_TASKS[task](), self.point_episodes)
        yield found


def _beside_truth(model: OffPolicyAlgorithm, env: KnownTask) -> Row:
    """Columns of what an agent says of its newest transitions; DDPG has a mu only."""
    buffer = model.replay_buffer
    newest = np.arange(buffer.pos - min(buffer.size(), FRESH), buffer.pos)  # in a full buffer, negative ones are older
    states, actions = (array[newest, 0].astype(float) for array in (buffer.observations, buffer.actions))
    true_mu, mu = env.mu(states), model.predict(states.astype(np.float32), deterministic=True)[0]
    found = {
        "true_curvature": env.curvature,
        "distance_of_mu": float(np.sqrt(np.square(mu - true_mu).mean() / np.square(true_mu).mean())),
        "saturated": float((np.abs(mu) > SATURATED).mean()),
    }
    if not isinstance(model, Watched):
        return found
    model.policy.set_training_mode(False)
    observations = th.as_tensor(states, dtype=th.float32)
    with th.no_grad():
        values = model.q_net.all_values(observations, th.as_tensor(actions, dtype=th.float32))
        lower = model.q_net.lower(observations).double().numpy()
    return found | {
        "v_minus_true": float((values.best[:, 0].double().numpy() - env.value(states)).mean()),
        "curvature": float(np.linalg.eigvalsh(lower @ lower.transpose(0, 2, 1))[:, -1].mean()),
        "gap_over_true": (values.best - values.q).mean().item() / float(env.gap(states, actions).mean()),
    }


def _score(make: Callable[[int], KnownTask], model: OffPolicyAlgorithm, episodes: int) -> float:
    """Return in some episodes, the same for all, from that of the centre, 0, to that of the best law, 1."""

    def earned(law: Callable[[KnownTask, np.ndarray], np.ndarray]) -> float:
        env, total = make(EVALUATION_SEED), 0.0
        for _ in range(episodes):
            state, truncated = env.reset()[0], False
            while not truncated:
                state, reward, _, truncated, _ = env.step(law(env, state))
                total += reward
        return total

    idle = earned(lambda env, state: np.zeros(env.action_space.shape))
    best = earned(lambda env, state: env.mu(state[None])[0])
    return (earned(lambda env, state: model.predict(state)[0]) - idle) / (best - idle)


FULL = KnownTasks()
QUICK = KnownTasks(steps=102, seeds=1, episodes=1, point_steps=102, point_seeds=1, point_episodes=1)
OF_KNOWN = f"the median of {FULL.seeds} seeds after {FULL.steps} steps."


def of_seeds(rows: DataFrame, column: str, how: str) -> DataFrame:
    """Statistic of the seeds: a row for each task that has the column, and a column for each algorithm.

    :param rows: of the result
    :param column: name of the column
    :param how: name of the statistic
    """
    known = rows.dropna(subset=[column])
    wide = known.groupby(["task", "algorithm"])[column].agg(how).unstack()
    return wide.reindex(index=unique(known, ["task"]), columns=unique(known, ["algorithm"]))


def _of_known(rows: DataFrame) -> DataFrame:
    """Rows of tasks whose truth is known."""
    return rows[rows["task"].isin(KNOWN_TASKS)]


def _quoted(names: Index[Any]) -> str:
    """Names of tasks in a sentence."""
    return ", ".join(f"“{name}”" for name in names) or "none"


def answer(rows: DataFrame) -> str:
    """How NAF does where the truth is known."""
    scores, ratios = of_seeds(rows, "score", "median"), of_seeds(_of_known(rows), "v_over_bound", "max")
    behind, published = scores.index[scores.NAF <= scores.DDPG], ratios["NAF with V, as published"]
    return (
        f"Where the truth is known, NAF's median score is above DDPG's on {len(scores) - len(behind)} of {len(scores)} "
        f"tasks, but not on {_quoted(behind)}. Its V comes to {shown(ratios.NAF.max(), '.2f')} of the bound at most. "
        f"With V in the targets, as published, V runs away on {_quoted(ratios.index[published > 1])}: it comes to "
        f"{shown(published.max(), '.1f')} times the bound."
    )


def points_answer(rows: DataFrame) -> str:
    """How NAF does where a place is to be reached."""
    returns = of_seeds(rows, "return", "median")
    ahead, level = (returns.NAF > returns.TD3).sum(), (returns.NAF == returns.TD3).sum()
    behind, above_ddpg = returns.index[returns.NAF < returns.TD3], returns.index[returns.NAF > returns.DDPG]
    highest = of_seeds(rows, "v_over_bound", "max").NAF[returns.index].max()
    return (
        f"Where a point is moved, NAF's median return is above TD3's on {ahead or 'none'} of {len(returns)} tasks, "
        f"equal on {level}, and below it on {_quoted(behind)}. It is above DDPG's on {_quoted(above_ddpg)} only. V "
        f"comes to {shown(highest, '.2f')} of its bound at most."
    )


def scores(rows: DataFrame) -> str:
    """Scores on all tasks whose truth is known."""
    caption = f"Return from that of the centre, 0, to that of the best law, 1, in {FULL.episodes} episodes: {OF_KNOWN}"
    return _beside(of_seeds(rows, "score", "median"), caption)


def bounds(rows: DataFrame) -> str:
    """How near V comes to its bound on these tasks."""
    caption = f"Largest V of a batch over its bound: the worst of {FULL.seeds} seeds in {FULL.steps} steps."
    return _beside(of_seeds(_of_known(rows), "v_over_bound", "max"), caption)


def _beside(found: DataFrame, caption: str) -> str:
    """A table with a column for each task."""
    wide = found.T.reset_index()
    return table(wide, list(wide), caption, **dict.fromkeys(found.index, ".2f"))


def six_actions(rows: DataFrame) -> str:
    """What the values say of six actions."""
    six = rows[rows["task"].str.startswith("six")]
    found = six.groupby(["task", "algorithm"], sort=False)[list(VALUES)].median().reset_index()
    formats = dict.fromkeys(VALUES, ".2f") | {"v_minus_true": ".1f", "saturated": ".0%"}
    return table(found, ["task", "algorithm", *VALUES], f"With six actions: {OF_KNOWN}", **formats)


def returns(rows: DataFrame) -> str:
    """Returns where a place is to be reached."""
    grouped = rows.dropna(subset=["return"]).groupby(["task", "algorithm"], sort=False)["return"]
    found = grouped.agg(median="median", lowest="min", highest="max").reset_index()
    caption = f"Return of {FULL.point_episodes} episodes of {FULL.point_seeds} seeds after {FULL.point_steps} steps."
    return table(found, list(found), caption, median=".2f", lowest=".2f", highest=".2f")
