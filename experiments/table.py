"""Every result and what makes it: the one table that commands, ``make results`` and tests read."""

from __future__ import annotations

from pathlib import Path

from experiments.balance_trainings import BalanceTrainings
from experiments.benchmarks.table import BENCHMARKS
from experiments.box_limit import BoxLimit
from experiments.ceiling import Ceiling
from experiments.conditions import Conditions
from experiments.contexts import Contexts
from experiments.endurance.table import ENDURANCE
from experiments.flexion_laws import FlexionLaws
from experiments.goal_tasks import GoalTasks
from experiments.held_actions import HeldActions
from experiments.hopper_actions import HopperActions
from experiments.known_truth import KnownTruth
from experiments.lateral_limit import LateralLimit
from experiments.maker import Maker
from experiments.naf_preset import NafPreset
from experiments.observed_reward import ObservedReward
from experiments.operation import Operation
from experiments.other_sizes import OtherSizes, Robot
from experiments.race import Race
from experiments.rank_replay import RankReplay
from experiments.robustness import Robustness
from experiments.rough_ground import RoughGround
from experiments.scaled_actions import ScaledActions
from experiments.second_training import SecondTraining, SecondTrainingSummary
from experiments.sensor_faults import SensorFaults
from experiments.several_actions import SeveralActions
from experiments.shift_endings import ShiftEndings
from experiments.shipped_parameters import ShippedParameters
from experiments.shipping_rule import Round, Shipping
from experiments.slots import SlotsSchedule
from experiments.slots_cost import SlotsCost
from experiments.standard_tasks import NAF_VARIANTS, StandardTask
from experiments.stepping_and_hips import SteppingAndHips

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
    "contexts": Maker(
        "Do parameters that follow the ground do better than one set for all grounds?",
        Contexts(),
        {"seeds": 1, "budget": 2, "episodes": 1, "time_limit": 1.1},
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
    "rank_replay": Maker(
        "What does ranked replay make of a noisy reward?",
        RankReplay(),
        {"seeds": 1, "episodes": 8},
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
    "held_actions": Maker(
        "What does an action decide on Hopper where NAF stays, and what do values make of it?",
        HeldActions(),
        {"steps": 120, "seeds": 1, "draws": 2, "held_steps": (1,)},
        of_robot=False,
    ),
    "hopper_actions": Maker(
        "What does it change on Hopper if actions are held for several steps, larger, or noisier?",
        HopperActions(),
        {
            "actions": ("held for four steps",),
            "steps": 480,
            "seeds": 1,
            "evaluations": 1,
            "episodes": 1,
            "courses": Path("build/experiments/several_actions"),
        },
        of_robot=False,
    ),
    "scaled_actions": Maker(
        "Where the best action is at the bounds, what do actions change that reach them sooner?",
        ScaledActions(),
        {"tasks": ("six actions, clear",), "steps": 120, "seeds": 1, "episodes": 1},
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
    "slots_cost": Maker(
        "What do slots cost a training?",
        SlotsCost(),
        {**TRAINED, "slots": (1,), "seeds": 1, "budget": 8, "episodes": 1},
    ),
    "slots_schedule": Maker(
        "How many slots a worker keep the workers busy?",
        SlotsSchedule(),
        {**TRAINED, "seed": 0, "episodes_per_worker": 2},
        of_robot=False,
    ),
    # The controller.
    "shift_endings": Maker(
        "Which of its conditions ends SHIFT?",
        ShiftEndings(),
        {"time_limit": 3.0, "episodes": 1, "steady_from": 1.0, "p3": ()},
    ),
    "stepping_and_hips": Maker(
        "Does V1 help whatever P1 to P5 are?",
        SteppingAndHips(),
        {"time_limit": 1.1, "v1": (0.7,), "pushes": 1},
    ),
    "flexion_laws": Maker(
        "Which flexion law saves the robot from pushes from front and back?",
        FlexionLaws(),
        {"newtons": (105.0,), "pushes": 1, "reference_pushes": 0, "unpushed": 1, "time_limit": 1.2},
    ),
    "lateral_limit": Maker(
        "What decides whether the robot survives a push to the side?",
        LateralLimit(),
        {"newtons": (125.0,), "pushes": 1, "time_limit": 3.5},
    ),
    "box_limit": Maker(
        "Does the box around the start end episodes that the robot would have saved?",
        BoxLimit(),
        {"pushes": 1, "time_limit": 3.5},
    ),
    "sensor_faults": Maker(
        "Does the robot go on stepping when its sensors or its control loop fail?",
        SensorFaults(),
        {"time_limit": 1.1, "seeds": 1},
    ),
    **BENCHMARKS,
    **ENDURANCE,
}
"""What makes each result, by its name."""
