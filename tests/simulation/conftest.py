"""Simulations in each engine, which are closed after the test."""

from collections.abc import Iterator

import pytest
from laboratory import BuildSimulation, Laboratory, laboratory

from sarah.robot.description import describe_robot
from sarah.simulation.build import simulator_of
from sarah.simulation.physics import PHYSICS, Physics
from sarah.simulation.randomisation import NOMINAL, Conditions
from sarah.simulation.simulator import Simulator


@pytest.fixture
def lab(engine: str) -> Laboratory:
    """That of each engine in turn."""
    return laboratory(engine)


@pytest.fixture
def build(lab: Laboratory) -> Iterator[BuildSimulation]:
    """Function that builds a simulation of conditions and physics."""
    built: list[Simulator] = []

    def build_one(conditions: Conditions = NOMINAL, physics: Physics = PHYSICS["standard"]) -> Simulator:
        built.append(simulator_of(lab.engine)(describe_robot(), physics, conditions))
        return built[-1]

    yield build_one
    for simulation in built:
        simulation.close()
