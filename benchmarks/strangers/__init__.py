"""Files, sensors and studies of strangers: small inputs and whole captures against their right answers.

``python -m benchmarks strangers --only PART`` runs one part; ``--only`` may be repeated.
"""

from __future__ import annotations

from collections.abc import Mapping

from benchmarks.any_capture.plates import plate_rows
from benchmarks.checks import Check, Context
from benchmarks.parts import Part, part_rows
from benchmarks.strangers.holes import hole_rows
from benchmarks.strangers.makers_files import makers_file_rows
from benchmarks.strangers.marker_sets import marker_set_rows
from benchmarks.strangers.mixed_folders import mixed_folder_rows
from benchmarks.strangers.odd_c3d import odd_c3d_rows
from benchmarks.strangers.orientation_spreads import orientation_spread_rows
from benchmarks.strangers.plates import plate_point_rows
from benchmarks.strangers.shared_captures import shared_capture_rows
from benchmarks.strangers.small_inputs import small_input_rows
from benchmarks.strangers.two_persons import two_persons_rows

PARTS: Mapping[str, Part] = {
    "folders": lambda context: mixed_folder_rows(context.require_data(), context.out),
    "holes": lambda context: hole_rows(context.require_data()),
    "known_masses": lambda context: plate_rows(context.require_data()),
    "makers_files": lambda context: makers_file_rows(context.require_data(), context.out),
    "marker_sets": lambda context: marker_set_rows(context.require_data()),
    "odd_c3d": lambda context: odd_c3d_rows(context.require_data()),
    "orientation_spreads": lambda context: orientation_spread_rows(context.require_data()),
    "plate_points": lambda context: plate_point_rows(context.require_data()),
    "shared_captures": lambda context: shared_capture_rows(context.require_data(), context.out),
    "small_inputs": lambda context: small_input_rows(context.require_data(), context.out),
    "two_persons": lambda context: two_persons_rows(context.require_data()),
}
"""Rows by the part's name."""


def run(context: Context) -> list[Check]:
    """Rows of all parts, or of those of ``--only``.

    Raises:
        UnknownName: A part of ``--only`` does not exist.
    """
    return part_rows(context, PARTS)
