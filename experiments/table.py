"""Every result and what makes it: the one table that commands, ``make results`` and tests read."""

from __future__ import annotations

from pathlib import Path

from experiments.balance_trainings import BalanceTrainings
from experiments.benchmarks.table import BENCHMARKS
from experiments.ceiling import Ceiling
from experiments.clock import Clock
from experiments.conditions import Conditions
from experiments.engines import Engines
from experiments.maker import Maker
from experiments.goal_tasks import GoalTasks
from experiments.known_truth import KnownTruth
from experiments.landscape import Landscape
from experiments.naf_preset import NafPreset
from experiments.observed_reward import ObservedReward
from experiments.operation import Operation
from experiments.other_sizes import OtherSizes, Robot
from experiments.physics import FinenessAnywhere, FinenessInConditions
from experiments.race import Race
from experiments.robot_dimensions import RobotDimensions
from experiments.robustness import Robustness
from experiments.rough_ground import RoughGround
from experiments.second_training import SecondTraining, SecondTrainingSummary
from experiments.sensor_faults import SensorFaults
from experiments.several_actions import SeveralActions
from experiments.shipped_parameters import ShippedParameters
from experiments.shipping_rule import Round, Shipping
from experiments.standard_tasks import NAF_VARIANTS, StandardTask
from experiments.transfer import TransferBetweenEngines

SHORT = {"time_limit": 2.0}
TRAINED = {**SHORT, "budget": 5}
RACED = {**TRAINED, "seeds": 1, "algorithms": ("cma-es",), "courses": Path("build/experiments/race")}
BALANCED = {**TRAINED, "engines": ("mujoco",), "seeds": 1}
BEST_KNOWN = {**BALANCED, "judging": 3, "candidates": 4}

TABLE: dict[str, Maker] = {
    # What trainings learn.
    "other_sizes": Maker(
        "Do robots of other sizes learn by the same commands?",
        OtherSizes(),
        {
            **SHORT,
            "robots": (Robot(4.0, 0.2, 5.4),),
            "engines": ("mujoco",),
            "seeds": 1,
            "budgets": (5, 5),
            "episodes": 1,
        },
    ),
    "balance_trainings": Maker(
        "Which V1 to V4 does each Second Training recommend, and which does its network say?",
        BalanceTrainings(),
        BALANCED,
    ),
    "second_training": Maker(
        "Does the robot learn to come back after a push, and where do V1 to V4 settle?",
        SecondTraining(),
        {**BEST_KNOWN, "surviving": 1},
    ),
    "second_training_summary": Maker(
        "How close do Second Trainings come to the best known V1 to V4?",
        SecondTrainingSummary(),
        {**BEST_KNOWN, "surviving": 1},
    ),
    "ceiling": Maker(
        "How much better than the shipped V1 to V4 could be?",
        Ceiling(),
        BEST_KNOWN,
    ),
    "shipping": Maker(
        "Which V1 to V4 does the shipping rule choose, and why?",
        Shipping(),
        {**BALANCED, "rounds": (Round(None, 3, 1),)},
    ),
    "shipped_parameters": Maker(
        "Which parameters does the package ship, and how well do they do?",
        ShippedParameters(),
        {**BALANCED, "rounds": (Round(None, 3),), "episodes": 1},
    ),
    "robustness": Maker(
        "How hard a push does the robot come back from?",
        Robustness(),
        {**TRAINED, "seed": 0, "episodes": 2, "forces": (150.0,)},
    ),
    "conditions": Maker(
        "What do the shipped parameters do on slopes, with faulty sensors and under pushes?",
        Conditions(),
        {"episodes": 1, "reference_episodes": 0, "time_limit": 1.2, "pushed_seconds": 1.2},
    ),
    "rough_ground": Maker(
        "What do the shipped parameters do on bumps and on ground that slips?",
        RoughGround(),
        {"episodes": 1, "reference_episodes": 0, "time_limit": 1.1},
    ),
    "transfer_stepping": Maker(
        "How much of its score does a First Training keep in the other engine?",
        TransferBetweenEngines("stepping", episodes=5, budget=100),
        {**TRAINED, "seeds": 1, "episodes": 2},
    ),
    "transfer_balance": Maker(
        "How much of its score does a Second Training keep in the other engine?",
        TransferBetweenEngines("balance", episodes=20, budget=300),
        {**TRAINED, "seeds": 1, "episodes": 2},
    ),
    # A robot that goes on.
    "operation": Maker(
        "What is it worth to renew parameters while the robot runs?",
        Operation(),
        {"seeds": 1, "other_seeds": 1, "minutes": 0.1, "best_seeds": 1, "best_minutes": 0.1},
    ),
    "observed_reward": Maker(
        "Does the reward that the robot observes rank parameters as equation 2 does?",
        ObservedReward(),
        {"sets": 4, "minutes": 0.1},
    ),
    # Algorithms.
    "race_stepping": Maker(
        "Which algorithm learns to step in the fewest episodes?",
        Race("stepping", budget=60, first_seed=100),
        {**RACED, "evaluations": 1},
    ),
    "race_balance": Maker(
        "Which algorithm learns to come back after a push in the fewest episodes?",
        Race("balance", budget=150, first_seed=300, evaluations_along=12),
        {**RACED, "evaluations": 1, "evaluations_along": 1},
    ),
    "naf_preset": Maker(
        "What is each part of NAF's preset for episodes of one step worth?",
        NafPreset(),
        {"seeds": 1, "episodes": 5},
        of_robot=False,
    ),
    "known_truth": Maker(
        "What does NAF make of tasks whose truth is known?",
        KnownTruth(),
        {"steps": 102, "seeds": 1, "episodes": 1},
        of_robot=False,
    ),
    "several_actions": Maker(
        "How does NAF do on tasks with several actions, next to DDPG?",
        SeveralActions(),
        {
            "tasks": ("Swimmer-v5",),
            "steps": 120,
            "seeds": 1,
            "evaluations": 1,
            "episodes": 1,
            "courses": Path("build/experiments/several_actions"),
        },
        of_robot=False,
    ),
    "goal_tasks": Maker(
        "How does NAF do where a place is to be reached, next to DDPG and TD3?",
        GoalTasks(),
        {"steps": 102, "seeds": 1, "episodes": 1},
        of_robot=False,
    ),
    "naf_pendulum": Maker(
        "How does NAF do on Pendulum-v1, next to TD3, SAC and DDPG?",
        StandardTask("Pendulum-v1", steps=10_000, seeds=10),
        {"steps": 120, "seeds": 1, "episodes": 1},
        of_robot=False,
    ),
    "pendulum_variants": Maker(
        "What do noise, pull and dropout change for NAF on Pendulum-v1?",
        StandardTask("Pendulum-v1", steps=10_000, algorithms=tuple(NAF_VARIANTS), seeds=10),
        {"steps": 120, "seeds": 1, "episodes": 1},
        of_robot=False,
    ),
    "naf_inverted_pendulum": Maker(
        "How does NAF do on InvertedPendulum-v5, next to TD3, SAC and DDPG?",
        StandardTask("InvertedPendulum-v5", steps=5000),
        {"steps": 120, "seeds": 1, "episodes": 1},
        of_robot=False,
    ),
    # The controller.
    "landscape_stepping": Maker(
        "What does each of P1 to P5 do, one at a time around (0.4, 1, 0.1, 1, 1)?",
        Landscape("stepping", seeds=3, time_limit=12.0),
        {**SHORT, "seeds": 1, "points": 1},
    ),
    "landscape_balance": Maker(
        "What does each of V1 to V4 do, one at a time around (1, 0, 0, 0) under pushes of 100 N?",
        Landscape("balance", seeds=12, time_limit=8.0),
        {**SHORT, "seeds": 1, "points": 1},
    ),
    "clock": Maker(
        "Can a learner use the time-outs as a clock?",
        Clock(),
        {**SHORT, "random_sets": 1},
    ),
    "sensor_faults": Maker(
        "Does the robot go on stepping when its sensors or its control loop fail?",
        SensorFaults(),
        {"time_limit": 1.1, "seeds": 1},
    ),
    "robot_dimensions": Maker(
        "What does each dimension of the robot do for its stability?",
        RobotDimensions(),
        {"time_limit": 1.1, "pushed_seconds": 1.1, "pushes": 1, "unpushed": 1},
    ),
    # The physics.
    "physics": Maker(
        "How far are the scores of coarser physics from those of the finest, with delay and without?",
        FinenessInConditions(),
        {"time_limit": 1.2, "seeds": 2, "sets": 1, "control_rates": (100,), "delays": (0.010,)},
    ),
    "physics_anywhere": Maker(
        "How far are the scores of P1 to P5 from anywhere in their box from those of the finest physics?",
        FinenessAnywhere(),
        {"time_limit": 1.2, "seeds": 2, "sets": 1},
    ),
    "engines": Maker(
        "How far do the two physics engines agree?",
        Engines(),
        {**SHORT, "seeds": 1},
    ),
    **BENCHMARKS,
}
"""What makes each result, by its name."""
