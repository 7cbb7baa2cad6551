from collections.abc import Iterator

import pytest

from sarah.training import train


@pytest.fixture(autouse=True, scope="module")
def short_summary() -> Iterator[None]:
    """An evaluation on two seeds at the end of each training."""
    with pytest.MonkeyPatch.context() as monkeypatch:
        monkeypatch.setattr(train, "SUMMARY_EPISODES", 2)
        yield
