"""Dropout by random bytes."""

import pytest
import torch as th

from sarah.agents.dropout import ByteDropout


@pytest.mark.parametrize("share", [0.1, 0.9])
def test_the_share_is_left_out_and_the_mean_stays(share):
    th.manual_seed(0)
    units = ByteDropout(share)(th.ones(401, 999))  # 8 bytes are drawn at a time, which do not come out even
    assert units.shape == (401, 999)
    assert (units == 0).double().mean().item() == pytest.approx(share, abs=0.5 / 256 + 0.003)
    assert units.mean().item() == pytest.approx(1, abs=0.02)
    assert len(units.unique()) == 2


def test_units_are_left_out_independently():
    th.manual_seed(0)
    kept = (ByteDropout(0.5)(th.ones(2000, 64)) > 0).float()
    correlations = th.corrcoef(kept.T) - th.eye(64)
    assert correlations.abs().max() < 0.12  # five standard deviations of 2000 draws
    assert th.corrcoef(th.stack([kept[:-1].flatten(), kept[1:].flatten()]))[0, 1].abs() < 0.02


def test_what_is_left_out_learns_nothing():
    units = th.rand(64, 32, requires_grad=True)
    kept = ByteDropout(0.25)(units)
    kept.sum().backward()
    th.testing.assert_close(units.grad, th.where(kept == 0, 0.0, 1 / 0.75))


def test_a_seed_decides_what_is_left_out():
    def draw(seed):
        th.manual_seed(seed)
        return ByteDropout(0.2)(th.ones(5, 7))

    assert th.equal(draw(3), draw(3)) and not th.equal(draw(3), draw(4))


def test_nothing_is_left_out_when_acting_or_with_a_share_of_0():
    units = th.rand(9, 9)
    assert ByteDropout(0.5).eval()(units) is units
    assert ByteDropout(0.0)(units) is units
