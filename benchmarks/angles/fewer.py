"""The same walk with fewer markers: means of the sagittal angles, read as Plug-in Gait reads them, must stay."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from benchmarks.angles.archives import ARCHIVES, Archive, followed
from benchmarks.checks import Check, information
from mbkf.io.records import Capture
from mbkf.trial.scale import scale

MOST_DEG = 2.0

ANGLES = tuple(f"{joint}_{side}" for joint in ("hip_flexion", "knee_angle", "ankle_angle") for side in "rl")

LEGS = ("SACR", *(side + name for side in "RL" for name in ("ASI", "THI", "KNE", "TIB", "ANK", "HEE", "TOE")))
TRUNK = ("C7", "T10", "CLAV", "STRN", "RBAK", *(side + name for side in "RL" for name in ("FHD", "BHD")))
ARMS = tuple(side + name for side in "RL" for name in ("SHO", "ELB", "WRA", "WRB", "FIN"))
SETS = {"legs only": LEGS, "36 markers": (*LEGS, *TRUNK, *ARMS, "RD5M", "LD5M")}
"""Names that are kept of the full set of 59."""

WALKS = ARCHIVES[:2]
"""Those whose full set has more than the legs."""


def fewer_rows(data: Path) -> list[Check]:
    """The rows of all walks.

    Args:
        data: Folder of the reference captures.
    """
    return [row for one in WALKS for row in _rows(one, data)]


def _rows(one: Archive, data: Path) -> list[Check]:
    pig, isb, model = (_most_apart(one, data, angles) for angles in ("pig", "isb", "model"))
    return [
        Check(
            f"{one.name}, full set, legs, 36 markers: most apart in the mean ({pig[0]})",
            pig[1],
            MOST_DEG,
            "<=",
            "°",
        ),
        information(f"{one.name}, the same in the ISB's axes ({isb[0]})", isb[1], "°"),
        information(f"{one.name}, the same in the body's own axes ({model[0]})", model[1], "°"),
    ]


def _most_apart(one: Archive, data: Path, angles: str) -> tuple[str, float]:
    """The sagittal angle whose means over the sets are most apart, and by how much, degrees."""
    walk, static = one.read(data)
    means = [_means(walk, static, one.mass_kg, angles)]
    for kept in SETS.values():
        means.append(
            _means(only(walk, kept), None if static is None else only(static, kept), one.mass_kg, angles)
        )
    apart = np.ptp(means, axis=0)
    return ANGLES[int(apart.argmax())].replace("_", " "), float(apart.max())


def only(capture: Capture, kept: tuple[str, ...]) -> Capture:
    """The capture with these of its markers."""
    return replace(
        capture, markers=capture.markers.select(tuple(n for n in capture.markers.names if n in kept))
    )


def _means(walk: Capture, static: Capture | None, mass_kg: float, angles: str) -> list[float]:
    """Means of the sagittal angles, degrees."""
    found = followed(walk, scale(static, [walk], mass_kg=mass_kg), angles)
    return [float(np.rad2deg(np.nanmean(found.angle(name)))) for name in ANGLES]
