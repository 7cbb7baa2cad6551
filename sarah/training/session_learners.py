"""What learns in a session, by the name that the command takes: a search, or an agent of an environment."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from sarah.operation.operated_robot import OperatedRobot
from sarah.operation.settings import BOX, Parameters
from sarah.recognition.recognition import Recognition, shipped_recognition
from sarah.runs.agent_settings import AgentSettings, EvolutionSettings
from sarah.training.optimisers import EvolutionStrategy, RandomSearch
from sarah.training.search import Search, Start

AROUND_THE_FIRST = EvolutionSettings(deviation=0.16, population=10)
"""Settings of CMA-ES in a session: a robot in operation is not to leave the parameters that it walks with at once."""


def operate(robot: OperatedRobot, search: Search) -> Parameters:
    """Operate a robot with the parameters that a search asks for, a window each, until the operation is over.

    :param robot: robot to operate
    :param search: search, which is told the reward that the robot itself observes
    :return: parameters to leave the robot with
    """
    while not robot.is_over:
        parameters = search.ask(robot.windows_left)
        window = robot.run(parameters)
        search.tell(parameters, window.observed_reward, window.fell)
    return search.choice()


def _none(robot: OperatedRobot, first: Parameters, seed: int) -> Parameters:
    while not robot.is_over:
        robot.run(first)
    return first


def _random(robot: OperatedRobot, first: Parameters, seed: int) -> Parameters:
    return operate(robot, RandomSearch(AgentSettings(), BOX, seed, Start(first)))


def _evolution(robot: OperatedRobot, first: Parameters, seed: int) -> Parameters:
    return operate(robot, EvolutionStrategy(AROUND_THE_FIRST, BOX, seed, Start(first)))


def _careful(robot: OperatedRobot, first: Parameters, seed: int) -> Parameters:
    from sarah.training.careful import CarefulSearch  # slow to import because of scikit-learn

    return operate(robot, CarefulSearch(BOX, seed, first))


def _naf(robot: OperatedRobot, first: Parameters, seed: int) -> Parameters:
    from sarah.training.session_agent import operate_by_naf  # slow to import because of torch

    return operate_by_naf(robot, first, seed)


def _recognise(
    robot: OperatedRobot, first: Parameters, seed: int, recognition: Recognition | None = None
) -> Parameters:
    from sarah.training.recognise import operate_recognised  # slow to import because of scikit-learn

    return operate_recognised(robot, first, seed, recognition or shipped_recognition())


Learner = Callable[[OperatedRobot, Parameters, int], Parameters]
LEARNERS: dict[str, Learner] = {
    "none": _none,
    "careful": _careful,
    "naf": _naf,
    "cma-es": _evolution,
    "random": _random,
    "recognise": _recognise,
}
"""Functions that operate a robot until its time is over, and return the parameters to leave it with: of the robot, the
parameters of its first window and a seed."""


def learner_of(name: str, recognition: Recognition | None = None) -> Learner:
    """The learner of a session.

    :param name: name of the learner
    :param recognition: what logs teach, for the learner that recognises its robot; by default what the package ships
    """
    return LEARNERS[name] if recognition is None else partial(_recognise, recognition=recognition)
