"""What is written is what is read back."""

import struct
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from mbkf.errors import InvalidInput
from mbkf.io.c3d import read_c3d
from mbkf.io.c3d_decode import decode
from mbkf.io.c3d_layout import check_layout
from mbkf.io.c3d_write import write_c3d
from mbkf.io.capture_options import CaptureOptions
from mbkf.io.plate_corners import plate_axes
from mbkf.io.records import (
    AnalogChannel,
    Capture,
    CaptureEvent,
    DerivedPoint,
    MarkerTrajectories,
    PlateReadings,
    SampleScaling,
)
from tests.io.c3d_builder import standing_points

UP = np.array([0.0, 0.0, 1.0])
quick = settings(max_examples=15, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])


def markers_of(positions, names=None, rate_hz=100.0, start_time_s=0.0):
    names = names or tuple(f"M{i}" for i in range(positions.shape[1]))
    return MarkerTrajectories(tuple(names), positions, rate_hz, start_time_s)


def plate_of(frames=50, per_frame=10, start_time_s=0.0, corners=True, rate_hz=100.0):
    rng = np.random.default_rng(2)
    origin = np.array([0.4, -0.3, 0.1])
    outline = origin + np.array([[0.3, -0.2, 0.0], [-0.3, -0.2, 0.0], [-0.3, 0.2, 0.0], [0.3, 0.2, 0.0]])
    samples = frames * per_frame
    force = rng.normal([0, 0, 500], [30, 30, 100], (samples, 3))
    moment = rng.normal(0.0, 40.0, (samples, 3))
    pressure = origin + np.cross(UP, moment) / force[:, 2:]
    return PlateReadings("1", rate_hz * per_frame, start_time_s, origin, force, moment, pressure, 20.0,
                         outline if corners else None)  # fmt: skip


@quick
@given(
    values=arrays(np.float64, (6, 5, 3), elements=st.floats(-3.0, 3.0, width=32)),
    hidden=arrays(np.bool_, (6, 5)),
    rate_hz=st.sampled_from([50.0, 59.94, 100.0, 119.88, 250.0]),
    first=st.integers(0, 2000),
    unlabelled=st.booleans(),
)
def test_markers_round_trip(tmp_path, values, hidden, rate_hz, first, unlabelled):
    values = np.where(hidden[:, :, None] | (values == 0.0).all(axis=2, keepdims=True), np.nan, values)
    names = tuple(f"*{i}" for i in range(5)) if unlabelled else ("LASI", "RASI", "T10", "Top.Head", "R MT5")
    markers = markers_of(values, names, rate_hz, first / rate_hz)
    path = tmp_path / "a.c3d"
    write_c3d(Capture("", markers), path)
    back = read_c3d(path, CaptureOptions(unit="mm")).markers
    assert (back.names, back.rate_hz, back.start_time_s) == (names, rate_hz, pytest.approx(first / rate_hz))
    np.testing.assert_allclose(back.positions_m, values, atol=1e-6)


@pytest.mark.parametrize("corners", [True, False])
def test_everything_round_trips(tmp_path, corners):
    positions = standing_points(50) / 1e3
    plate = plate_of(start_time_s=0.5, corners=corners)
    emg = np.sin(np.arange(500) / 7.0)
    angle = DerivedPoint("LKneeAngles", "angle", np.arange(150.0).reshape(50, 3), "deg")
    centre = DerivedPoint("LHJC", "point", positions[:, 0] * 1e3, "mm")
    events = (CaptureEvent("Foot Strike", "Left", 0.61), CaptureEvent("Foot Off", "Right", 62.25))
    capture = Capture(
        "", markers_of(positions, start_time_s=0.5), (plate,), (angle, centre),
        (AnalogChannel("EMG", emg, "V", 1000.0),), events, subject_mass_kg=71.5,
    )  # fmt: skip
    write_c3d(capture, tmp_path / "a.c3d")
    back = read_c3d(tmp_path / "a.c3d", CaptureOptions(tare=False))
    np.testing.assert_allclose(back.markers.positions_m, positions, atol=1e-6)
    (again,) = back.plates
    assert (again.rate_hz, again.start_time_s) == (1000.0, 0.5)
    for name in ("origin_m", "force_n", "moment_nm", "centre_of_pressure_m"):
        np.testing.assert_allclose(getattr(again, name), getattr(plate, name), atol=1e-4)
    if corners:
        np.testing.assert_allclose(again.corners_m, plate.corners_m, atol=1e-6)
    assert back.events == events
    assert back.subject_mass_kg == 71.5
    assert [(d.name, d.kind, d.unit) for d in back.derived] == [
        ("LKneeAngles", "angle", "deg"),
        ("LHJC", "point", "mm"),
    ]
    for found, given_point in zip(back.derived, (angle, centre), strict=True):
        np.testing.assert_allclose(found.values, given_point.values, atol=1e-3)
    np.testing.assert_allclose(back.analog[-1].values, emg, atol=1e-6)
    assert (back.analog[-1].name, back.analog[-1].unit) == ("EMG", "V")


def test_places_among_derived_points_are_turned_into_world_axes(tmp_path):
    positions = standing_points(5) / 1e3
    centre = DerivedPoint("LHJC", "point", np.tile([1.0, 2.0, 3.0], (5, 1)), "cm")
    write_c3d(Capture("", markers_of(positions), derived=(centre,), up_axis="y"), tmp_path / "a.c3d")
    np.testing.assert_allclose(
        read_c3d(tmp_path / "a.c3d", CaptureOptions()).derived[0].values[0], [10.0, -30.0, 20.0], atol=1e-5
    )


def test_rates_that_do_not_divide_are_interpolated(tmp_path):
    positions = standing_points(60) / 1e3
    plate = plate_of(frames=100, per_frame=10, rate_hz=100.0)
    ramp = np.arange(1000.0)[:, None] * np.ones(3)
    plate = replace(
        plate, force_n=ramp, moment_nm=0.0 * ramp, centre_of_pressure_m=np.full((1000, 3), np.nan)
    )
    write_c3d(Capture("", markers_of(positions, rate_hz=60.0), (plate,)), tmp_path / "a.c3d")
    (back,) = read_c3d(tmp_path / "a.c3d", CaptureOptions(tare=False)).plates
    assert back.rate_hz == 17 * 60.0
    inside = back.times_s < 0.99
    np.testing.assert_allclose(back.force_n[inside, 2], 1000.0 * back.times_s[inside], atol=1e-2)


def test_many_markers_round_trip(tmp_path):
    positions = standing_points(2, 400) / 1e3
    write_c3d(Capture("", markers_of(positions)), tmp_path / "a.c3d")
    back = read_c3d(tmp_path / "a.c3d", CaptureOptions()).markers
    assert back.names == tuple(f"M{i}" for i in range(400))
    np.testing.assert_allclose(back.positions_m, positions, atol=1e-6)


def test_what_cannot_be_written_is_refused_and_leaves_nothing(tmp_path):
    with pytest.raises(InvalidInput, match=r"named \.c3d"):
        write_c3d(Capture("", markers_of(standing_points() / 1e3)), tmp_path / "a.txt")
    with pytest.raises(InvalidInput, match="no frames"):
        write_c3d(Capture("", markers_of(np.zeros((0, 3, 3)))), tmp_path / "a.c3d")
    assert list(tmp_path.iterdir()) == []


def test_more_plates_than_the_format_counts_are_refused_and_as_many_as_it_counts_come_back(tmp_path):
    positions, plate = standing_points(3) / 1e3, plate_of(frames=3)
    with pytest.raises(InvalidInput, match="258 analog channels"):
        write_c3d(Capture("", markers_of(positions), (plate,) * 43), tmp_path / "a.c3d")
    write_c3d(Capture("", markers_of(positions), (plate,) * 42), tmp_path / "b.c3d")
    assert len(read_c3d(tmp_path / "b.c3d", CaptureOptions()).plates) == 42


def test_computed_places_with_names_of_their_own_do_not_come_back_as_markers(tmp_path):
    positions = standing_points(5) / 1e3
    place = DerivedPoint("Anything", "point", np.tile([1.0, 2.0, 3.0], (5, 1)), "m", "what it is, x ° y")
    write_c3d(Capture("", markers_of(positions), derived=(place,)), tmp_path / "a.c3d")
    back = read_c3d(tmp_path / "a.c3d", CaptureOptions())
    assert "Anything" not in back.markers.names
    (found,) = back.derived
    assert (found.name, found.kind, found.unit, found.description) == (
        "Anything", "point", "mm", "what it is, x ? y",
    )  # fmt: skip
    np.testing.assert_allclose(found.values, 1e3 * place.values, rtol=1e-6)


@pytest.mark.parametrize("count", [255, 256, 700])
def test_more_events_than_a_list_holds_come_back(tmp_path, count):
    labels = ("Foot Strike", "Foot Off", "General")
    events = tuple(CaptureEvent(labels[k % 3], ("Left", "Right")[k % 2], 0.25 * k) for k in range(count))
    write_c3d(Capture("", markers_of(standing_points(5) / 1e3), events=events), tmp_path / "a.c3d")
    assert read_c3d(tmp_path / "a.c3d", CaptureOptions()).events == events


def test_corners_that_form_no_rectangle_become_those_of_the_one_with_their_axes(tmp_path):
    """Programs that take the axes from other sides compute the same force: every angle is right to 32 bits."""
    plate = plate_of()
    moved = np.array([[0.01, 0.0, 0.0], [0.0, 0.006, 0.001], [0.0, 0.0, 0.0], [-0.004, 0.01, 0.002]])
    skewed = plate.corners_m + moved
    path = tmp_path / "a.c3d"
    write_c3d(Capture("", markers_of(np.ones((50, 1, 3))), (replace(plate, corners_m=skewed),)), path)
    corners = read_c3d(path, CaptureOptions(unit="mm")).plates[0].corners_m
    x, y = corners[0] - corners[1], corners[0] - corners[3]
    assert abs(x @ y) < 1e-7 and np.linalg.norm(corners[0] - corners[1] + corners[2] - corners[3]) < 1e-6
    np.testing.assert_allclose(plate_axes(corners), plate_axes(skewed), atol=1e-6)
    np.testing.assert_allclose(corners.mean(axis=0), skewed.mean(axis=0), atol=1e-6)


def test_channels_keep_their_values_with_scalings_that_the_file_cannot_hold(tmp_path):
    """The format has one general scale, which is 1 where channels differ; offsets are integers of 16 bits."""
    values = np.arange(500.0)
    scalings = (
        SampleScaling(0.5, 0.25, 7.0),
        SampleScaling(2.0),
        SampleScaling(0.125, offset=-40000.0),
        SampleScaling(0.25, offset=0.5),
    )
    channels = [AnalogChannel(f"C{k}", values, "V", 1000.0, one) for k, one in enumerate(scalings)]
    write_c3d(Capture("", markers_of(np.ones((50, 1, 3))), analog=tuple(channels)), tmp_path / "a.c3d")
    for found in read_c3d(tmp_path / "a.c3d", CaptureOptions(unit="mm")).analog:
        np.testing.assert_array_equal(found.values, values)


@pytest.mark.parametrize(("largest_mm", "step_mm"), [(5.1, 0.02), (1.0, 0.01)])
def test_residuals_are_steps_of_the_scale(tmp_path, largest_mm, step_mm):
    """As in Qualisys' files: 0.4 mm is byte 4 of scale −0.1. ezc3d 1.7 reads the word's other half (its issue 386)."""
    residuals = 1e-3 * np.array([[0.4, largest_mm], [1e-3, np.nan], [0.0, 0.5]])
    positions = np.ones((3, 3, 3))
    positions[2, 1] = np.nan
    path = tmp_path / "x.c3d"
    write_c3d(Capture("x", markers_of(positions)), path, residuals_m=residuals)
    found = decode(path, check_layout(path))
    scale = found.parameters.number("POINT", "SCALE")
    assert scale == pytest.approx(-step_mm) and struct.unpack_from("<f", path.read_bytes(), 12) == (scale,)
    expected = [[0.4, largest_mm, 0.0], [step_mm, 0.0, 0.0], [0.0, -1.0, 0.0]]
    read = np.where(found.residuals < 0.0, -1.0, -scale * found.residuals)
    np.testing.assert_allclose(read, expected, atol=1e-6)
    assert (found.residuals == np.round(found.residuals)).all()
    np.testing.assert_allclose(found.points[0], 1000.0)


@pytest.mark.parametrize("residuals", [None, np.full((2, 1), np.nan), np.zeros((2, 1))])
def test_a_file_without_residuals_stays_as_it_was(tmp_path, residuals):
    capture = Capture("x", markers_of(np.ones((2, 1, 3))))
    for name, some in (("one", None), ("other", residuals)):
        write_c3d(capture, tmp_path / f"{name}.c3d", residuals_m=some)
    assert (tmp_path / "one.c3d").read_bytes() == (tmp_path / "other.c3d").read_bytes()
