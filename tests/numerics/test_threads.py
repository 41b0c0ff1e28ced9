"""The number of BLAS threads inside and outside the guard."""

import numpy as np
import pytest
from threadpoolctl import threadpool_info, threadpool_limits

from mbkf.numerics.threads import single_threaded


def blas_threads():
    np.ones((2, 2)) @ np.ones((2, 2))
    return [library["num_threads"] for library in threadpool_info() if library["user_api"] == "blas"]


def test_inside_there_is_one_thread_and_afterwards_as_many_as_before():
    with threadpool_limits(limits=2, user_api="blas"):
        before = blas_threads()
        assert before
        with single_threaded():
            assert set(blas_threads()) == {1}
        assert blas_threads() == before


def test_an_error_inside_still_gives_the_threads_back():
    with threadpool_limits(limits=2, user_api="blas"):
        before = blas_threads()
        with pytest.raises(ZeroDivisionError), single_threaded():
            _ = 1 / 0
        assert blas_threads() == before


def test_the_guard_can_be_nested():
    with single_threaded():
        with single_threaded():
            assert set(blas_threads()) == {1}
        assert set(blas_threads()) == {1}
