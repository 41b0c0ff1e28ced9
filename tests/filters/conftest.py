"""Small matrices on one thread, as the pipelines run them."""

import pytest

from mbkf.numerics.threads import single_threaded


@pytest.fixture(scope="session", autouse=True)
def one_thread():
    with single_threaded():
        yield
