"""Order of the plates: two that are taken for each other.

Where feet stand on one plate after the other, exchanged plates leave no frame in which the load is known. In a squat
they carry what the motion requires, but at each other's place: what they read is tried at the other's place for every
pair of plates that bear.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import combinations

import numpy as np

from mbkf.conventions import Array
from mbkf.io.findings import Finding
from mbkf.io.records import PlateReadings
from mbkf.trial.checks.evidence import Evidence
from mbkf.trial.checks.orientation import TIMES_SD, better_fit

BOUND = 2.0
"""Misfit over that of exchanged plates from which these are right."""

BEARS, MOST_PLATES = 0.1, 4
"""A plate counts that bears this share of the weight in the mean of the frames in which plates carry the load; of more
plates than these, the most loaded count."""


def order_finding(evidence: Evidence) -> tuple[Finding | None, tuple[PlateReadings, ...]]:
    """A finding on the pair of plates that fit better in each other's place, and the plates as they fit; None if right.

    Args:
        evidence: Motion and plates.
    """
    frames = evidence.carried
    if not frames.any():
        return None, evidence.plates
    bears = evidence.given[frames, :, 2].mean(axis=0) / evidence.weight_n
    loaded = sorted((p for p in range(len(bears)) if bears[p] > BEARS), key=lambda p: -bears[p])
    pairs = list(combinations(sorted(loaded[:MOST_PLATES]), 2))
    times, best = better_fit(evidence, _sums(evidence, pairs)) if pairs else (0.0, None)
    if best is None or not times > BOUND:
        return None, evidence.plates
    one, other = (evidence.plates[p].name for p in pairs[best])
    hint = f"in each other's place they fit {times:.1f} times as well: check the order of their channels and corners"
    finding = Finding(
        f"order of plates '{one}' and '{other}'", times, TIMES_SD, "times", BOUND, "outside", hint
    )
    return finding, _exchanged(evidence.plates, *pairs[best])


def _sums(evidence: Evidence, pairs: Sequence[tuple[int, int]]) -> list[Array]:
    """(T, 6) wrench of all plates together with each pair exchanged: a force acts where the other plate is."""
    summed = np.repeat(evidence.raw.sum(axis=1)[:, None], len(pairs), axis=1)
    for k, (a, b) in enumerate(pairs):
        by = evidence.plates[a].origin_m - evidence.plates[b].origin_m
        summed[:, k, 3:] += np.cross(by, evidence.raw[:, b, :3] - evidence.raw[:, a, :3])
    return list(evidence.averaged(summed).swapaxes(0, 1))


def _exchanged(plates: tuple[PlateReadings, ...], a: int, b: int) -> tuple[PlateReadings, ...]:
    found = list(plates)
    found[a], found[b] = in_place_of(plates[a], plates[b]), in_place_of(plates[b], plates[a])
    return tuple(found)


def in_place_of(place: PlateReadings, other: PlateReadings) -> PlateReadings:
    """Readings of another plate at a plate's place.

    Args:
        place: The plate whose place, corners and name they get.
        other: The plate that reads.
    """
    by = place.origin_m - other.origin_m
    return replace(
        other,
        name=place.name,
        origin_m=place.origin_m,
        centre_of_pressure_m=other.centre_of_pressure_m + by,
        corners_m=place.corners_m,
    )
