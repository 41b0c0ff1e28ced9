"""C3D files made for tests, through the library's own writer and independent of ours."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import ezc3d
import numpy as np

CORNERS_MM = np.array(
    [[500.0, 100.0, 0.0], [500.0, -300.0, 0.0], [-100.0, -300.0, 0.0], [-100.0, 100.0, 0.0]]
).T
"""(3, 4) corners of a plate 600 × 400 mm whose own x is world y, own y is world x and own z points down."""

PLATE_AXES = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]])
"""Columns: its axes in the world."""

CENTRE_M = np.array([0.2, -0.1, 0.0])


@dataclass
class Plate:
    """A plate as FORCE_PLATFORM describes it; channels are (S, C)."""

    kind: int
    channels: np.ndarray
    corners: np.ndarray = field(default_factory=lambda: CORNERS_MM)
    origin: tuple[float, float, float] = (0.0, 0.0, 0.0)
    units: tuple[str, ...] = ("N", "N", "N", "Nmm", "Nmm", "Nmm")
    calibration: np.ndarray | None = None


def standing_points(frames: int = 10, markers: int = 8) -> np.ndarray:
    """(T, N, 3) points in mm spread like a person's markers."""
    heights = np.linspace(50.0, 1700.0, markers)
    points = np.column_stack([np.linspace(-200, 200, markers), np.linspace(100, 300, markers), heights])
    return np.tile(points, (frames, 1, 1)) + np.arange(frames)[:, None, None]


def build_c3d(
    path: Path,
    points: np.ndarray | None = None,
    labels: list[str] | None = None,
    plates: tuple[Plate, ...] = (),
    *,
    rate_hz: float = 100.0,
    unit: str = "mm",
    residuals: np.ndarray | None = None,
    extra: dict[tuple[str, str], object] | None = None,
    first_frame: int = 0,
) -> Path:
    """Write a file and return its path. ``extra`` maps (group, name) to a value."""
    points = standing_points() if points is None else points
    frames, count, _ = points.shape
    content = ezc3d.c3d()
    content["header"]["points"]["first_frame"] = first_frame
    group = content["parameters"]["POINT"]
    group["LABELS"]["value"] = labels or [f"M{i}" for i in range(count)]
    group["UNITS"]["value"] = [unit] if unit else []
    group["RATE"]["value"] = [rate_hz]
    content["data"]["points"] = np.pad(points, ((0, 0), (0, 0), (0, 1)), constant_values=1.0).transpose(
        2, 1, 0
    )
    if residuals is not None:
        content["data"]["meta_points"]["residuals"] = residuals.T[None].astype(float)
    if plates:
        _add_plates(content, plates, frames, rate_hz)
    for (name, parameter), value in (extra or {}).items():
        content.add_parameter(name, parameter, value)
    content.write(str(path))
    return path


def _add_plates(content: ezc3d.c3d, plates: tuple[Plate, ...], frames: int, rate_hz: float) -> None:
    channels = np.hstack([plate.channels for plate in plates]).T
    group = content["parameters"]["ANALOG"]
    group["RATE"]["value"] = [rate_hz * channels.shape[1] / frames]
    group["LABELS"]["value"] = [f"C{i}" for i in range(len(channels))]
    group["UNITS"]["value"] = [unit for plate in plates for unit in plate.units]
    content["data"]["analogs"] = channels[None]
    most = max(plate.channels.shape[1] for plate in plates)
    numbers, used = np.zeros((most, len(plates))), 0
    for i, plate in enumerate(plates):
        width = plate.channels.shape[1]
        numbers[:width, i] = np.arange(used + 1, used + width + 1)
        used += width
    add = content.add_parameter
    add("FORCE_PLATFORM", "USED", len(plates))
    add("FORCE_PLATFORM", "TYPE", [plate.kind for plate in plates])
    add("FORCE_PLATFORM", "CORNERS", np.stack([plate.corners for plate in plates], axis=2))
    add("FORCE_PLATFORM", "ORIGIN", np.array([plate.origin for plate in plates]).T)
    add("FORCE_PLATFORM", "CHANNEL", numbers)
    if any(plate.calibration is not None for plate in plates):
        blocks = [np.zeros((6, 6)) if plate.calibration is None else plate.calibration for plate in plates]
        add("FORCE_PLATFORM", "CAL_MATRIX", np.stack(blocks, axis=2))
