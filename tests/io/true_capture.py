"""A small true capture for readers of laboratories' files: markers and two plates with moving pressure."""

import numpy as np

from benchmarks.any_capture.dialects import TrueCapture, TruePlate
from mbkf.io.records import MarkerTrajectories, PlateReadings

RATE_HZ = 500.0
FRAMES = 60
SAMPLES = 300


def made_truth(start_s: float = 0.0) -> TrueCapture:
    """Eight markers at 100 Hz, some hidden, and two plates at 500 Hz that are stepped on one after the other."""
    rng = np.random.default_rng(5)
    positions = (
        rng.uniform(-0.8, 0.8, (8, 3)) + [0.0, 0.0, 1.0] + np.linspace(0.0, 0.5, FRAMES)[:, None, None]
    )
    positions[10:14, 2] = np.nan
    markers = MarkerTrajectories(tuple("ABCDEFGH"), positions, 100.0, start_s)
    return TrueCapture(markers, (made_plate(0.3, 20, 180), made_plate(0.9, 140, 280)), RATE_HZ)


def made_plate(x_m: float, first: int, last: int) -> TruePlate:
    """A plate of 0.6 by 0.4 m around (x, 0.2, 0), turned a little, loaded between two samples."""
    phase = np.clip((np.arange(SAMPLES) - first) / (last - first), 0.0, 1.0)
    size = np.sin(np.pi * phase)
    force = np.outer(size, [0.0, 20.0, 750.0])
    force[:, 0] = -120.0 * np.sin(2.0 * np.pi * phase)
    middle = np.array([x_m, 0.2, 0.0])
    point = middle + np.outer(size > 0.0, [1.0, 1.0, 0.0]) * np.column_stack(
        [0.24 * phase - 0.12, 0.03 * phase, 0.0 * phase]
    )
    quarter = np.array([[0.3, -0.2], [-0.3, -0.2], [-0.3, 0.2], [0.3, 0.2]])  # plate axes have z down
    turn = np.array([[np.cos(0.1), -np.sin(0.1)], [np.sin(0.1), np.cos(0.1)]])
    corners = middle + np.column_stack([quarter @ turn.T, np.zeros(4)])
    return TruePlate(corners, force, point, 6.0 * np.sin(2.0 * np.pi * phase))


def check_plates(true: TrueCapture, plates: tuple[PlateReadings, ...]) -> None:
    """Wrenches about the world's origin, centres of pressure and times are the true ones."""
    assert len(plates) == len(true.plates)
    for truth, plate in zip(true.plates, plates, strict=True):
        np.testing.assert_allclose(plate.times_s, true.times_s, atol=1e-9)
        about_origin = plate.moment_nm + np.cross(plate.origin_m, plate.force_n)
        np.testing.assert_allclose(np.hstack([plate.force_n, about_origin]), truth.wrench, atol=1e-6)
        pressed = truth.force_n[:, 2] >= plate.threshold_n
        np.testing.assert_allclose(plate.centre_of_pressure_m[pressed], truth.point_m[pressed], atol=1e-8)
        assert np.isnan(plate.centre_of_pressure_m[~pressed]).all()


def check_markers(true: TrueCapture, markers: MarkerTrajectories) -> None:
    """Names, times, positions and missing samples are the true ones."""
    assert (markers.names, markers.rate_hz) == (true.markers.names, true.markers.rate_hz)
    np.testing.assert_allclose(markers.times_s, true.markers.times_s, atol=1e-6)
    np.testing.assert_allclose(markers.positions_m, true.markers.positions_m, atol=1e-9)
