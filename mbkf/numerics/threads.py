"""One BLAS thread for small matrices: splitting a 100 × 100 product over cores costs ten times as much as it saves."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import scipy.linalg  # noqa: F401, a BLAS loaded later would not be limited
from threadpoolctl import threadpool_limits


@contextmanager
def single_threaded() -> Iterator[None]:
    """Inside, linear algebra of this process uses one thread."""
    with threadpool_limits(limits=1, user_api="blas"):
        yield
