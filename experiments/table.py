"""Every result and what makes it: the one table that commands, ``make results`` and tests read."""

from __future__ import annotations

from pathlib import Path

from experiments.balance_trainings import BalanceTrainings
from experiments.benchmarks.table import BENCHMARKS
from experiments.box_limit import BoxLimit
from experiments.ceiling import Ceiling
from experiments.clock import Clock
from experiments.conditions import Conditions
from experiments.contexts import Contexts
from experiments.endurance.table import ENDURANCE
from experiments.engines import Engines
from experiments.maker import Maker
from experiments.flexion_laws import FlexionLaws
from experiments.goal_tasks import GoalTasks
from experiments.held_actions import HeldActions
from experiments.hopper_actions import HopperActions
from experiments.known_truth import KnownTruth
from experiments.landscape import Landscape
from experiments.lateral_limit import LateralLimit
from experiments.naf_preset import NafPreset
from experiments.physics import FinenessAnywhere, FinenessInConditions
from experiments.rank_replay import RankReplay
from experiments.robot_dimensions import RobotDimensions
from experiments.robustness import Robustness
from experiments.rough_ground import RoughGround
from experiments.scaled_actions import ScaledActions
from experiments.second_training import SecondTraining, SecondTrainingSummary
from experiments.several_actions import SeveralActions
from experiments.shift_endings import ShiftEndings
from experiments.shipped_parameters import ShippedParameters
from experiments.shipping_rule import Round, Shipping
from experiments.slots import SlotsSchedule
from experiments.slots_cost import SlotsCost
from experiments.standard_tasks import NAF_VARIANTS, StandardTask
from experiments.stepping_and_hips import SteppingAndHips
from experiments.transfer import TransferBetweenEngines

SHORT = {"time_limit": 2.0}
TRAINED = {**SHORT, "budget": 5}
BALANCED = {**TRAINED, "engines": ("mujoco",), "seeds": 1}
BEST_KNOWN = {**BALANCED, "judging": 3, "candidates": 4}

TABLE: dict[str, Maker] = {
    # What trainings learn.
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
    # Algorithms.
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
    "shift_endings": Maker(
        "Which of its conditions ends SHIFT?",
        ShiftEndings(),
        {"time_limit": 3.0, "episodes": 1, "steady_from": 1.0, "p3": ()},
    ),
    "clock": Maker(
        "Can a learner use the time-outs as a clock?",
        Clock(),
        {**SHORT, "random_sets": 1},
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
    **ENDURANCE,
}
"""What makes each result, by its name."""
