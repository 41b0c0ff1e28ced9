"""The key numbers of a result for spreadsheets: one row of those that people chart, and a list of all others.

Rows of many trials stand below each other, since every trial has the same columns.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path

from mbkf.io.atomic import write_text
from mbkf.io.atomic_folder import replacing_beside
from mbkf.io.results import Reconstruction
from mbkf.trial.exchange.result_csv import csv_text, leaves
from mbkf.trial.results.summary import summarise

MORE = "_more"
"""Ends the name of the file with all other numbers."""

_PARTS = (
    "pelvis", "trunk", "right_leg", "left_leg", "right_arm", "left_arm", "right_leg_loads", "left_leg_loads",
    "trunk_loads",
)  # fmt: skip

_JOINTS = ("hip_r", "knee_r", "ankle_r", "hip_l", "knee_l", "ankle_l", "lumbar")

CHARTED: Mapping[str, str] = {
    "trial": "trial",
    "protocol": "protocol",
    "filter": "filter",
    "version": "version",
    "mass_kg": "mass_kg",
    "frames": "frames",
    "rate_hz": "rate_hz",
    "duration_s": "duration_s",
    "progression": "progression.kind",
    "verdict": "verdict.overall",
    **{f"verdict_{part}": f"verdict.parts.{part}" for part in _PARTS},
    "markers_used": "markers_used",
    "markers_explained": "markers_explained",
    "missing_fraction": "missing_fraction",
    "marker_rms_mm": "marker_rms_mm",
    "marker_max_mm": "marker_max_mm",
    "hidden_marker_rms_mm": "hidden_marker_rms_mm",
    "residual_force_rms_n": "residual_force_rms_n",
    "residual_moment_rms_nm": "residual_moment_rms_nm",
    "residual_force_share": "residual_force_share",
    "residual_lever_m": "residual_lever_m",
    "valid_frames": "valid_frames",
    "measured_frames": "measured_frames",
    "plate_force_change_rms_n": "plate_force_change_rms_n",
    **{f"{joint}_peak_nm_per_kg": f"torque_peak_nm_per_kg.{joint}" for joint in _JOINTS},
    **{f"{joint}_sd_nm": f"torque_sd_nm.{joint}" for joint in _JOINTS},
    "l5_s1_peak_nm_per_kg": "trunk_moments.L5/S1.peak_nm_per_kg",
    "l5_s1_sd_nm": "trunk_moments.L5/S1.sd_nm",
    "nis_per_dof": "nis_per_dof",
    "nis_markers": "nis.markers",
    "nis_plates": "nis.plates",
    "realtime_factor": "realtime_factor",
}
"""Columns of the row, and the path of each in summary.json."""


def write_summary_csv(r: Reconstruction, path: str | Path) -> None:
    """Writes the row, and beside it the list, ``NAME_more.csv``: both or neither.

    Args:
        r: The result.
        path: The file of the row.

    Raises:
        OSError: A file cannot be written.
    """
    found = dict(leaves(summarise(r)))
    path = Path(path)
    row = [_text(found.get(key)) for key in CHARTED.values()]
    with replacing_beside(path) as partial:
        write_text(partial / path.name, csv_text(tuple(CHARTED), iter([row])))
        write_text(
            partial / more_path(path).name, csv_text(("trial", "key", "value"), _others(r.trial, found))
        )


def more_path(path: Path) -> Path:
    """The file of all other numbers beside that of the row."""
    return path.with_name(f"{path.stem}{MORE}{path.suffix}")


def _others(trial: str, found: Mapping[str, object]) -> Iterator[tuple[str, str, str]]:
    charted = set(CHARTED.values())
    return ((trial, key, _text(value)) for key, value in found.items() if key not in charted)


def _text(value: object) -> str:
    return "" if value is None else str(value)
