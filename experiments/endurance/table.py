"""Every result of what kills, takes protections out or runs long, and what makes it."""

from __future__ import annotations

from experiments.endurance.killed_workers import KilledWorkers
from experiments.endurance.kills import Kills
from experiments.endurance.long_run import LongProcess, LongTraining
from experiments.endurance.mutants import Mutants
from experiments.endurance.protections import Protections
from experiments.endurance.resume import Resume
from experiments.maker import Maker

ENDURANCE: dict[str, Maker] = {
    "kills": Maker(
        "Does a training that is killed at random moments end as without?",
        Kills(),
        {"kills": 1},
        of_robot=False,
    ),
    "killed_workers": Maker(
        "What do killed workers cost a training?",
        KilledWorkers(),
        {"budget": 8, "seconds_between_kills": 20.0},
        of_robot=False,
    ),
    "resume": Maker(
        "What does it cost to resume a training?",
        Resume(),
        {"algorithms": ("cma-es",), "budget": 5},
        of_robot=False,
    ),
    "long_process": Maker(
        "Do many episodes in one process stay flat in memory and open files?",
        LongProcess(),
        {"episodes": 10},
        of_robot=False,
    ),
    "long_training": Maker(
        "Does a long training with two workers stay flat in memory and open files?",
        LongTraining(),
        {"budget": 8},
        of_robot=False,
    ),
    "protections": Maker(
        "Does a test fail when a protection is taken out?",
        Protections(),
        {"count": 1},
        of_robot=False,
    ),
    "mutants": Maker(
        "How many changes to core files do the tests of their package see?",
        Mutants(),
        {"files": "sarah/episode/reward.py", "count": 2},
        of_robot=False,
    ),
}
"""What makes each of these results, by its name."""
