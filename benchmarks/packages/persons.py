"""A person with sizes and sides of its own and markers, on whom functions of packages are judged."""

from __future__ import annotations

import mbkf
from mbkf.io.subject import Subject


def person(seed: int) -> Subject:
    """A synthetic person: scaled, right and left apart, with marker places.

    Args:
        seed: Which one.
    """
    return mbkf.synthesise("squat", seconds=1.0, seed=seed)[0]
