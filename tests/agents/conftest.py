import pytest
import torch as th


@pytest.fixture(autouse=True, scope="session")
def one_thread():
    """Networks this small run many times slower on several threads of a busy machine."""
    threads = th.get_num_threads()
    th.set_num_threads(1)
    yield
    th.set_num_threads(threads)
