"""The search through all readings of the text: how near they come to the printed numbers, and how far they spread."""

from __future__ import annotations

import numpy as np

from benchmarks.stride_paper.readings import HEADS, NEAR_M, NUMBERS, PRINTED_M, Readings
from benchmarks.thesis_report.contents import CANNOT_BE_HAD, OPEN, Band, Claim, Findings, Row, Sheet

LEAST_READINGS, NEAREST_SHOWN = 320, 10


def reading_findings(found: Readings) -> Findings:
    """Bounds, tables and the claim.

    Args:
        found: All readings.
    """
    count = len(found.words)
    all_four = found.near(0, 1, 2, 3)
    bands = [
        Band("readings", "readings of the text that were run", float(count), LEAST_READINGS, OPEN, "", False),
        Band("readings", f"of these, four printed numbers given to {NEAR_M} m", float(all_four), -OPEN, 0.0, "", False),
        Band("readings", "the nearest reading's largest distance", float(found.distances_m.min()), NEAR_M, OPEN, "m",
             False),
    ]  # fmt: skip
    return Findings(bands, [_spread_sheet(found), _nearest_sheet(found)], [_claim(found, all_four)])


def _spread_sheet(found: Readings) -> Sheet:
    rows: tuple[Row, ...] = tuple(
        (
            name,
            float(PRINTED_M[k]),
            *(float(value) for value in np.percentile(found.values_m[:, k], [0, 5, 50, 95, 100])),
            float(found.near(k)),
        )
        for k, name in enumerate(NUMBERS)
    )
    columns = (
        "error m", "paper", "least", "5 %", "median", "95 %", "largest", f"readings within {NEAR_M} m",
    )  # fmt: skip
    clean, drift = found.near(0, 1), found.near(2, 3)
    note = f"{len(found.words)} readings; {clean} within {NEAR_M} m of both clean numbers, {drift} of both with drift."
    return Sheet("readings", "All readings of the text", columns, rows, note)


def _nearest_sheet(found: Readings) -> Sheet:
    order = found.distances_m.argsort(kind="stable")[:NEAREST_SHOWN]
    rows: tuple[Row, ...] = tuple(
        (*found.words[k], *(float(value) for value in found.values_m[k]), float(found.distances_m[k]))
        for k in order
    )
    return Sheet(
        "nearest_readings",
        "The readings nearest to the paper",
        (*HEADS, *NUMBERS, "largest distance m"),
        rows,
    )


def _claim(found: Readings, all_four: int) -> Claim:
    k = found.nearest
    clean, clean_mean, drift, drift_mean = found.values_m[k]
    measured = (
        f"{all_four} of {len(found.words)} readings give the four numbers to {NEAR_M} m, {found.near(0, 1)} the two "
        f"clean ones, {found.near(2, 3)} the two of the drift. The nearest gives {clean:.2f}, {clean_mean:.2f}, "
        f"{drift:.2f} and {drift_mean:.2f} m. A mean of {PRINTED_M[1] / PRINTED_M[0]:.2f} of the final error asks "
        "for a first step without error and a second one that errs by all of it; the method treats both alike."
    )
    statement = "Clean and drift errors together: 0.32, 0.06, 0.47 and 0.12 m."
    return Claim("Figures 5, 7", statement, measured, CANNOT_BE_HAD if not all_four else "reproduced")
