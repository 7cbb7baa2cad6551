"""A payload: mass that the torso carries."""

import pytest
from laboratory import need

from sarah.episode.robot_settings import conditions_of
from sarah.episode.running_robot import RunningRobot
from sarah.episode.settings import EpisodeConfig
from sarah.errors import ConfigurationError
from sarah.robot.reading import GRAVITY
from sarah.simulation.engines import Engine
from sarah.simulation.randomisation import Randomisation


@pytest.mark.parametrize("engine", ["pybullet", "mujoco"])
def test_the_feet_carry_it(engine: Engine) -> None:
    need(engine)
    dimensions = {"torso_mass": 6.0, "hip_mass": 2.0}

    def load(payload: float) -> float:
        perfect = Randomisation(enabled=False)
        config = EpisodeConfig(engine=engine, randomisation=perfect, payload=payload, dimensions=dimensions)
        robot = RunningRobot(config, 0)
        reading = robot.stand()
        robot.close()
        return sum(reading.pressures)

    assert load(6.0) - load(0.0) == pytest.approx(6.0 * GRAVITY, rel=0.05)


def test_it_adds_to_what_the_seed_draws() -> None:
    without, carrying = (conditions_of(EpisodeConfig(payload=mass), 3).mass_factors for mass in (0.0, 4.0))
    assert carrying["torso"] == pytest.approx(without["torso"] + 4.0 / 8.0)
    assert {link: carrying[link] for link in carrying if link != "torso"} == {
        link: without[link] for link in without if link != "torso"
    }


@pytest.mark.parametrize("payload", [-1.0, 101.0])
def test_an_implausible_one_is_refused(payload: float) -> None:
    with pytest.raises(ConfigurationError, match=r"payload must be between 0 and 100 kg"):
        EpisodeConfig(payload=payload)
