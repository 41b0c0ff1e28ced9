"""Third differences of readings by the compiled kernel (``differences.h``)."""

from __future__ import annotations

from collections.abc import Sequence

from mbkf.conventions import Array
from mbkf.kernel.loading import library


def third_differences(samples: Sequence[Array], level: float) -> tuple[int, int] | None:
    """How many third differences are numbers, and how many of these lie below a level; None without a kernel.

    Args:
        samples: Four of them, of the same shape and in C order, the latest last; NaN where there is no reading.
        level: The level.
    """
    kernel = library()
    if kernel is None:
        return None
    first, second, third, latest = samples
    return kernel.third_differences(first, second, third, latest, level)
