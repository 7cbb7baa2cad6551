"""A payload: mass that the torso carries."""

import pytest

from sarah.episode.robot_settings import conditions_of
from sarah.episode.running_robot import RunningRobot
from sarah.episode.settings import EpisodeConfig
from sarah.errors import ConfigurationError
from sarah.robot.reading import GRAVITY
from sarah.simulation.engines import is_installed
from sarah.simulation.randomisation import Randomisation

AS_DESIGNED = Randomisation(enabled=False)


@pytest.mark.parametrize("engine", ["pybullet", "mujoco"])
@pytest.mark.parametrize("torso_mass", [8.0, 6.0])
def test_the_feet_carry_it(engine: str, torso_mass: float) -> None:
    if not is_installed(engine):
        pytest.skip(f"needs {engine}")
    dimensions = {"torso_mass": torso_mass, "hip_mass": (10.0 - torso_mass) / 2.0}

    def load(payload: float) -> float:
        config = EpisodeConfig(
            engine=engine,  # type: ignore[arg-type]
            randomisation=AS_DESIGNED,
            payload=payload,
            dimensions=dimensions,
        )
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


@pytest.mark.parametrize("payload", [-1.0, 101.0, float("nan")])
def test_an_implausible_one_is_refused(payload: float) -> None:
    with pytest.raises(ConfigurationError, match=r"payload must be between 0 and 100 kg"):
        EpisodeConfig(payload=payload)
