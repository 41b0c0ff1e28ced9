"""Stated spreads of orientations on BROAD's trials, axis by axis: error over spread, and cover by 95 % intervals.

Errors about north, west and up, over the movement phases that the files mark, in the authors' alignment of sensor and
cameras (Laidig et al., Data 2021, 6(7):72). Each axis is pooled over trials: a heading errs by an offset of the field
that lasts for a trial, so that a trial by itself is one draw of it, however long. Settings were chosen on these trials;
the page on the theory of inertial sensors states how those chosen on some of them do on the others.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from benchmarks.checks import Check, information, within
from benchmarks.inertial.against_vqf import followed, standardised
from mbkf.conventions import Array
from mbkf.io.imu.files import read_imu

AXES = ("north", "west", "up (heading)")
RATIO, COVER = (0.8, 1.25), (90.0, 97.0)
_WITHIN = 1.96


def orientation_spread_rows(data: Path) -> Iterator[Check]:
    """Rows of all trials in the data folder, smoothed and at once.

    Args:
        data: Folder of the public captures.
    """
    sensors = [one for path in sorted((data / "imu_broad").glob("*.mat")) for one in read_imu(path)]
    for method, kind in (("smooth", "smoothed"), ("ekf", "at once")):
        scaled = [
            standardised(course, one) for course, one in zip(followed(sensors, method), sensors, strict=True)
        ]
        squares = np.array([(z**2).mean(axis=0) for z in scaled])
        covers = 100.0 * np.array([(np.abs(z) < _WITHIN).mean(axis=0) for z in scaled])
        for axis, name in enumerate(AXES):
            yield from _axis(f"BROAD, {kind}, about {name}", squares[:, axis], covers[:, axis])


def _axis(name: str, squares: Array, covers: Array) -> Iterator[Check]:
    """Rows of one axis from each trial's mean square (n,) and cover (n,), %."""
    yield from within(f"{name}: error / stated sd, all trials", float(np.sqrt(squares.mean())), *RATIO)
    yield from within(f"{name}: cover of 95 % intervals", float(covers.mean()), *COVER, "%")
    alone = np.sqrt(squares)
    yield information(f"{name}: error / stated sd, least of a trial", float(alone.min()))
    yield information(f"{name}: error / stated sd, largest of a trial", float(alone.max()))
