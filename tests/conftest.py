"""What holds for all tests."""

import pytest
from hypothesis import HealthCheck, settings

# How long an example takes is a matter of the machine, and of what else runs on it.
settings.register_profile("any machine", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("any machine")


@pytest.fixture(params=["pybullet", "mujoco"])
def engine(request: pytest.FixtureRequest) -> str:
    from laboratory import need

    need(request.param)
    return str(request.param)
