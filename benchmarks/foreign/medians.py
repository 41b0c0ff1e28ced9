"""Committed medians of errors by set of persons, against which a later tree is held."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from benchmarks.checks import Check
from benchmarks.foreign.errors import Judged, Series
from benchmarks.references import rms

FILE = Path(__file__).with_name("baseline.toml")

WORSE = 1.05
"""By which factor a median may exceed its baseline."""

UNITS = {"raw": "°", "varying": "°", "hip": "mm", "moment": "N m/kg"}


def medians(found: Sequence[Judged]) -> dict[str, float]:
    """Medians over persons, motions and coordinates of the legs' RMS errors.

    Args:
        found: Reconstructed motions.

    Returns:
        "raw" and "varying" of angles in degrees, "hip" centres in mm, "moment" in N m/kg.
    """
    legs: list[Series] = [one for motion in found for one in motion.angles if one.group == "legs"]
    hips = [away for motion in found for (joint, _), away in motion.centres_m.items() if joint == "hip"]
    moments = [one for motion in found for one in motion.moments]
    return {
        "raw": float(np.median([rms(one.error) for one in legs])),
        "varying": float(np.median([rms(one.varying) for one in legs])),
        "hip": float(np.median([1e3 * rms(one) for one in hips])),
        "moment": float(np.median([rms(one.error) for one in moments])),
    }


def read_baseline(path: Path = FILE) -> dict[str, dict[str, float]]:
    """Committed medians by set of persons; empty where there is no file.

    Args:
        path: The file.
    """
    if not path.is_file():
        return {}
    table = tomllib.loads(path.read_text(encoding="utf-8"))
    return {name: {key: float(value) for key, value in held.items()} for name, held in table.items()}


def write_baseline(held: Mapping[str, Mapping[str, float]], path: Path = FILE) -> None:
    """Writes medians.

    Args:
        held: Medians by set of persons.
        path: The file.
    """
    lines = [
        "# Medians over persons, motions and coordinates: python -m benchmarks.foreign --update-baseline",
        "",
    ]
    for name, values in held.items():
        lines += [f'["{name}"]', *(f"{key} = {value:.4f}" for key, value in values.items()), ""]
    path.write_text("\n".join(lines), encoding="utf-8")


def median_rows(
    name: str, found: Sequence[Judged], baseline: Mapping[str, Mapping[str, float]]
) -> list[Check]:
    """Medians beside those of the baseline; without bound where it has no such set.

    Args:
        name: Set of persons.
        found: Their motions.
        baseline: Committed medians.
    """
    held = baseline.get(name, {})
    return [
        Check(f"{name}: median {key}", value, WORSE * held.get(key, np.inf), "<=", UNITS[key])
        for key, value in medians(found).items()
    ]
