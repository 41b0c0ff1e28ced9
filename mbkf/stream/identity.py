"""Identity of a stream that returns: markers are known by their names, plates by their place in the laboratory.

A force acts where its plate lies, so geometry says which plate a channel belongs to; names decide only between plates
whose geometry is the same or not known. Columns are mapped to the order that the run knows, or the stream is another
one.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from mbkf.errors import InvalidInput
from mbkf.io.records import PlateReadings
from mbkf.stream.source import StreamDescription

SAME_PLACE_M = 1e-3
"""Origins and corners of one plate agree within this: streams state single precision or rounded millimetres."""

SAME_RATE = 1e-3
"""Rates of one stream agree within this share."""

MOST_LISTED = 4
"""Missing markers that a message lists by name."""

Columns = NDArray[np.int64]


def named_columns(kind: str, known: Sequence[str], found: Sequence[str]) -> Columns:
    """(M,) place of every known name among those of a stream that returned; further ones are left out.

    Args:
        kind: "markers" or "sensors", for messages.
        known: (M,) names before.
        found: Names now.

    Raises:
        InvalidInput: A known name is missing, or stands for two.
    """
    missing = [name for name in known if name not in found]
    if missing:
        listed = ", ".join(missing[:MOST_LISTED]) + (" …" if len(missing) > MOST_LISTED else "")
        raise InvalidInput(f"it has other {kind} ({len(missing)} of {len(known)} are missing: {listed})")
    if found and not known:
        raise InvalidInput(f"it has other {kind} (names where the points had none)")
    if len(set(known)) < len(known) and tuple(known) == tuple(found):
        return np.arange(len(known))  # their order alone tells apart those of one name
    twice = sorted({name for name in known if found.count(name) > 1 or known.count(name) > 1})
    if twice:
        raise InvalidInput(f"it has two {kind} '{twice[0]}'")
    return np.array([found.index(name) for name in known], dtype=np.int64)


def plate_order(known: Sequence[PlateReadings], found: Sequence[PlateReadings]) -> Columns:
    """(K,) place of every known plate among those of a stream that returned.

    Raises:
        InvalidInput: Their number or rate is another one, or a known plate is not where it was.
    """
    if len(found) != len(known):
        raise InvalidInput(f"it has {len(found)} plates where {len(known)} are known")
    for before, now in zip(known, found, strict=True):
        same_rate(before.rate_hz, now.rate_hz)
    places = plate_places(known, found)
    for before, place in zip(known, places, strict=True):
        if place is None:
            raise InvalidInput(elsewhere(before, found))
    return np.array(places, dtype=np.int64)


def plate_places(known: Sequence[PlateReadings], found: Sequence[PlateReadings]) -> list[int | None]:
    """Place of every known plate among those found; None for a plate that is not where it was."""
    places: list[int | None] = []
    for before in known:
        here = [k for k, now in enumerate(found) if k not in places and _same_place(before, now)]
        if sum(_same_place(before, other) for other in known) > 1:
            here = [k for k in here if found[k].name == before.name]
        places.append(here[0] if len(here) == 1 else None)
    return places


def same_rate(known_hz: float, found_hz: float) -> None:
    """Compares the rates of a stream before and after it was gone.

    Raises:
        InvalidInput: They differ.
    """
    if not abs(found_hz / known_hz - 1.0) <= SAME_RATE:
        raise InvalidInput(f"it has {found_hz:g} Hz, another rate than the known {known_hz:g} Hz")


def moved_counts(known: StreamDescription | PlateReadings, found: StreamDescription | PlateReadings) -> int:
    """Number to add to a returned stream's counts, whose first frame or sample may have another time."""
    return round((found.start_time_s - known.start_time_s) * known.rate_hz)


def _same_place(one: PlateReadings, other: PlateReadings) -> bool:
    """True for equal origins and equal corners, in their order: it turns the axes of the forces."""
    if not np.allclose(one.origin_m, other.origin_m, rtol=0.0, atol=SAME_PLACE_M, equal_nan=True):
        return False
    if one.corners_m is None or other.corners_m is None:
        return one.corners_m is None and other.corners_m is None
    return bool(np.allclose(one.corners_m, other.corners_m, rtol=0.0, atol=SAME_PLACE_M, equal_nan=True))


def elsewhere(plate: PlateReadings, found: Sequence[PlateReadings]) -> str:
    """Sentence on a known plate that is not where it was."""
    named = [now for now in found if now.name == plate.name]
    if len(named) != 1:
        return f"plate '{plate.name}' is not where it was, or is not one of its plates"
    apart_mm = 1e3 * float(np.linalg.norm(named[0].origin_m - plate.origin_m))
    where = f"{apart_mm:.0f} mm from where it was" if apart_mm >= 1.0 else "where it was, with other corners"
    return f"plate '{plate.name}' lies {where}"
