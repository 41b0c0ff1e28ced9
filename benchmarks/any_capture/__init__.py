"""Any laboratory's capture: what mbkf makes of captures that no protocol or file of it was made for."""

from __future__ import annotations

from benchmarks.any_capture.axes import axes_rows
from benchmarks.any_capture.coverage import coverage_rows
from benchmarks.any_capture.direction import direction_rows
from benchmarks.any_capture.forces import forces_rows
from benchmarks.any_capture.keypoints import keypoint_rows
from benchmarks.any_capture.marker_sets import marker_set_rows
from benchmarks.any_capture.out_of_box import out_of_box_rows
from benchmarks.any_capture.plates import plate_rows
from benchmarks.checks import Check, Context


def run(context: Context) -> list[Check]:
    """Rows of all parts."""
    return [
        *axes_rows(context.require_data()),
        *forces_rows(context),
        *plate_rows(context.require_data()),
        *coverage_rows(),
        *direction_rows(context.require_data()),
        *keypoint_rows(context),
        *marker_set_rows(context.require_data(), quick=context.quick),
        *out_of_box_rows(context.require_data(), context.out / "out_of_box"),
    ]
