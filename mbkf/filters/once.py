"""A value that is made when it is first asked for, and kept: what the answer to a frame need not wait for."""

from __future__ import annotations

from collections.abc import Callable
from typing import Generic, TypeVar, cast

T = TypeVar("T")


class Once(Generic[T]):
    """Calls a function at most once. A plain object: ``functools.cache`` costs more to make than most such values."""

    __slots__ = ("_make", "_value")

    def __init__(self, make: Callable[[], T]) -> None:
        self._make: Callable[[], T] | None = make
        self._value: T | None = None

    def __call__(self) -> T:
        """The value."""
        if self._make is not None:
            # What the function was made from is let go with it.
            self._value, self._make = self._make(), None
        return cast(T, self._value)
