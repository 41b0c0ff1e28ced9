"""A time in which a muscle is active, as results hold it."""

from __future__ import annotations

import json
from dataclasses import dataclass


@dataclass(frozen=True)
class MuscleBurst:
    """A time in which a muscle is active.

    Attributes:
        muscle: One of the result's ``muscle_names``.
        from_s, to_s: Its begin and its end by the clock of the capture.
    """

    muscle: str
    from_s: float
    to_s: float


def bursts_of_text(text: str) -> tuple[MuscleBurst, ...]:
    """Bursts from the JSON of a file."""
    return tuple(MuscleBurst(**one) for one in json.loads(text))
