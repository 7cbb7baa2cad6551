"""Settings of the integration: what each engine takes of them."""

import dataclasses

import pytest

from sarah.errors import ConfigurationError
from sarah.robot.scale import Scale
from sarah.simulation.physics import PHYSICS, Physics, PyBulletPhysics, physics_for


def test_only_pybullet_has_an_inertia_to_add() -> None:
    assert [field.name for field in dataclasses.fields(Physics)] == ["rate", "solver_iterations", "control_rate"]
    assert PHYSICS["standard"].added_plate_inertia > PHYSICS["reference"].added_plate_inertia == 0.0


@pytest.mark.parametrize("name", PHYSICS)
def test_named_settings_go_to_mujoco_and_come_back(name: str) -> None:
    in_mujoco = physics_for("mujoco", PHYSICS[name], Scale())
    assert type(in_mujoco) is Physics
    assert (in_mujoco.rate, in_mujoco.solver_iterations) == (PHYSICS[name].rate, PHYSICS[name].solver_iterations)
    assert physics_for("mujoco", in_mujoco, Scale()) is in_mujoco
    assert physics_for("pybullet", in_mujoco, Scale()) == PHYSICS[name]


def test_named_settings_come_back_at_any_control_rate() -> None:
    reference = PHYSICS["reference"].at_control_rate(250)
    assert physics_for("pybullet", physics_for("mujoco", reference, Scale()), Scale()) == reference


def test_nameless_settings_get_the_standard_inertia_in_pybullet() -> None:
    taken = physics_for("pybullet", Physics(rate=400, solver_iterations=7, control_rate=200), Scale())
    assert taken == PyBulletPhysics(400, 7, 200, added_plate_inertia=PHYSICS["standard"].added_plate_inertia)
    own = PyBulletPhysics(400, 7, 200, added_plate_inertia=0.001)
    assert physics_for("pybullet", own, Scale()) is own
    assert physics_for("mujoco", own, Scale()) == Physics(400, 7, 200)


@pytest.mark.parametrize("inertia", [-0.001, 101.0])
def test_an_inertia_that_no_plate_has_is_refused(inertia: float) -> None:
    with pytest.raises(ConfigurationError, match=r"physics.added_plate_inertia must be between 0 and 100 kg m\^2"):
        PyBulletPhysics(added_plate_inertia=inertia)


@pytest.mark.parametrize("rate", [49, 1001, 100.5])
def test_control_rates_that_no_robot_has_are_refused(rate: float) -> None:
    with pytest.raises(ConfigurationError, match=rf"physics.control_rate must be .*, not {rate}"):
        PHYSICS["standard"].at_control_rate(rate)  # type: ignore[arg-type]


@pytest.mark.parametrize("name", ["rate", "solver_iterations", "control_rate"])
def test_rates_and_iterations_are_whole_numbers(name: str) -> None:
    with pytest.raises(ConfigurationError, match=f"physics.{name} must be a whole number, not 100.5"):
        Physics(**{name: 100.5})  # type: ignore[arg-type]


@pytest.mark.parametrize("rate", [50, 150, 1000])
def test_another_control_rate_keeps_at_least_the_rate(rate: int) -> None:
    for physics in PHYSICS.values():
        taken = physics.at_control_rate(rate)
        assert taken.control_rate == rate and taken.control_dt == 1.0 / rate
        assert physics.rate <= taken.rate < physics.rate + rate and taken.rate % rate == 0
