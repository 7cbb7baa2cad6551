"""Every timing and what makes it."""

from __future__ import annotations

from experiments.benchmarks.decisions import Decisions
from experiments.benchmarks.engines_speed import EnginesSpeed
from experiments.benchmarks.physics_speed import PhysicsSpeed
from experiments.benchmarks.terrain_speed import TerrainSpeed
from experiments.benchmarks.throughput import Throughput
from experiments.benchmarks.updates import Updates
from experiments.benchmarks.viewer import Viewer
from experiments.maker import Maker

BENCHMARKS: dict[str, Maker] = {
    "physics_speed": Maker(
        "How fast is each setting of the physics?",
        PhysicsSpeed(),
        {"time_limit": 1.2},
        of_robot=False,
    ),
    "terrain_speed": Maker(
        "What does rough ground cost in time?",
        TerrainSpeed(),
        {"episodes": 1, "time_limit": 1.2},
        of_robot=False,
    ),
    "engines_speed": Maker(
        "How many times as fast is an episode in MuJoCo?",
        EnginesSpeed(),
        {"time_limit": 2.0, "rounds": 2},
        of_robot=False,
    ),
    "throughput": Maker(
        "How fast are episodes simulated, and where does the time go?",
        Throughput(),
        {"time_limit": 2.0, "rounds": 1, "trainings": 1, "budget": 5},
        of_robot=False,
    ),
    "updates": Maker(
        "How many updates per second does NAF make, and TD3?",
        Updates(),
        {"updates": 2, "rounds": 1, "batch_size": 8},
        of_robot=False,
    ),
    "decisions": Maker(
        "How long does a training think between two episodes?",
        Decisions(),
        {"episodes": (10,), "rounds": 1},
        of_robot=False,
    ),
    "viewer": Maker(
        "How fast is the viewer?",
        Viewer(),
        {"rounds": 1, "seconds": 1.0},
        of_robot=False,
    ),
}
"""What makes each timing, by its name."""
