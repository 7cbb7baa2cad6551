"""What an episode's seed draws of the robot and the world."""

import dataclasses

from sarah.simulation.randomisation import Randomisation, draw_conditions


def test_everything_the_seed_draws_is_within_its_range() -> None:
    ranges = Randomisation()
    for seed in range(200):
        drawn = draw_conditions(ranges, seed)
        assert 0.7 <= drawn.friction <= 1.0
        assert 40.0 <= drawn.actuator_bandwidth <= 50.0
        assert 20.0 <= drawn.pad_threshold <= 40.0
        assert all(0.95 <= factor <= 1.05 for factor in drawn.mass_factors.values())
        assert len(set(drawn.mass_factors.values())) == len(drawn.mass_factors)


def test_changing_one_range_leaves_the_other_draws_alone() -> None:
    drawn = draw_conditions(Randomisation(), 5)
    other = draw_conditions(Randomisation(friction=(0.2, 0.3)), 5)
    assert 0.2 <= other.friction <= 0.3
    assert dataclasses.replace(other, friction=drawn.friction) == drawn


def test_randomisation_off_leaves_only_the_start_velocity() -> None:
    first, second = (draw_conditions(Randomisation(enabled=False), seed) for seed in (1, 2))
    assert first.start_velocity != second.start_velocity
    assert dataclasses.replace(first, start_velocity=second.start_velocity) == second
    assert set(first.mass_factors.values()) == {1.0} and first.acceleration_noise == 0.0 and first.delay_ticks == 0
