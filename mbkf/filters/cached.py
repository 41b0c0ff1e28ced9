"""A value that is computed when it is first asked for: work that the answer to a frame need not wait for."""

from __future__ import annotations

from collections.abc import Callable
from typing import Generic, TypeVar, cast

T = TypeVar("T")


class Cached(Generic[T]):
    """Calls a function at most once. A plain object: ``functools.cache`` costs more to make than most such values."""

    __slots__ = ("_make", "_value")

    def __init__(self, make: Callable[[], T]) -> None:
        self._make: Callable[[], T] | None = make
        self._value: T | None = None

    def __call__(self) -> T:
        """The value."""
        if self._make is not None:
            # The function is dropped, and with it the arrays that it refers to.
            self._value, self._make = self._make(), None
        return cast(T, self._value)
