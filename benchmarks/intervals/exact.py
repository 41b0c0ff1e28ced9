"""A walk of another body with exact truth (OpenSim's): mean offsets of joint angles against their stated spread.

Its joints are not placed and turned as ours, so an angle's zero differs by more than scaling can know; what the stated
offset has to cover is told by the rows.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from benchmarks.checks import Check, information
from mbkf.conventions import SIDES
from mbkf.io.capture import read_capture
from mbkf.io.storage import read_storage
from mbkf.trial.reconstruct import reconstruct
from mbkf.trial.scale import scale

ANGLES = {"hip_flexion": 1.0, "knee_angle": 1.0, "ankle_angle": 1.0, "elbow_flex": 1.0}
"""Flexion coordinates, ours and OpenSim's by the same name, and the sign between them."""


def exact_rows(data: Path) -> list[Check]:
    """|mean error| over the mean total standard deviation, at most 2, of every flexion angle."""
    folder = data / "synthetic_exact_truth"
    capture = read_capture(folder / "subject01_walk2_markers.trc", forces=folder / "subject01_walk2_grf.mot")
    subject = scale(None, [capture], mass_kg=72.84, height_m=1.808)
    found, truth = reconstruct(capture, subject), read_storage(folder / "subject01_coordinates_TRUTH.sto")
    rows: list[Check] = []
    for name, sign in ANGLES.items():
        for side in SIDES:
            column = f"{name}_{side}"
            exact = sign * np.interp(found.times_s, truth.times_s, truth.column(column))
            error = float(np.nanmean(found.angle(column) - exact))
            sd = float(np.nanmean(found.angle_sd(column)))
            rows.append(Check(f"exact truth: mean error / sd, {column}", abs(error) / sd, 2.0, "<="))
            rows.append(information(f"exact truth: mean error, {column}", float(np.degrees(error)), "deg"))
    return rows
