"""One BLAS thread for small matrices: splitting a 100 × 100 product over cores costs ten times as much as it saves."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache

import scipy.linalg  # noqa: F401, a BLAS loaded later would not be limited
from threadpoolctl import ThreadpoolController


@contextmanager
def single_threaded() -> Iterator[None]:
    """Inside, linear algebra of this process uses one thread."""
    with _pools().limit(limits=1, user_api="blas"):
        yield


@cache
def _pools() -> ThreadpoolController:
    """The libraries' threads; looking for them takes milliseconds, longer than a step of a filter."""
    return ThreadpoolController()
