"""Each plate type against sensor signals derived from a force at a known place."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mbkf.errors import FileFormatError
from mbkf.io.c3d_plates import (
    CALIBRATION_OF_TYPE,
    CHANNELS_OF_TYPE,
    RawPlate,
    check_geometry,
    wrench_at_surface,
)
from mbkf.io.plate_corners import plate_axes
from tests.io.c3d_builder import CORNERS_MM, PLATE_AXES

A_MM, B_MM, DEPTH_MM = 120.0, 200.0, 55.0
SENSORS = np.array([[A_MM, B_MM], [-A_MM, B_MM], [-A_MM, -B_MM], [A_MM, -B_MM]])
CALIBRATIONS = {
    kind: np.random.default_rng(kind).normal(0.0, 1.0, shape) + 20.0 * np.eye(*shape)
    for kind, shape in CALIBRATION_OF_TYPE.items()
}
N_MM = np.diag([1.0, 1.0, 1.0, 200.0, 200.0, 200.0])
"""Moments are some hundred times larger in N mm than forces in N."""

CALIBRATIONS[4], CALIBRATIONS[5] = N_MM @ CALIBRATIONS[4] @ np.linalg.inv(N_MM), N_MM @ CALIBRATIONS[5]

forces = st.tuples(st.floats(-300, 300), st.floats(-300, 300), st.floats(50, 2000))
places = st.tuples(st.floats(-150, 150), st.floats(-150, 150))


def plate_of(
    kind: int, readings: np.ndarray, origin=(0.0, 0.0, 0.0), units=("N",) * 3 + ("Nmm",) * 3, **more
):
    corners = more.pop("corners", CORNERS_MM)
    return RawPlate(
        1, kind, corners, np.array(origin), readings, tuple(units), 1000.0, more.pop("calibration", None)
    )


def signals(kind: int, F: np.ndarray, place: np.ndarray, torque: float, origin: np.ndarray) -> np.ndarray:
    """Channels in N and N mm of a force F (plate axes) at a place (mm, about the surface's centre)."""
    if kind == 1:
        return np.array([[*F, place[0] + origin[0], place[1] + origin[1], torque]])
    arm = np.array([*place, 0.0]) + origin  # from the transducers to the place
    wrench = np.concatenate([F, np.cross(arm, F)])
    wrench[5] += torque
    if kind == 2:
        return wrench[None]
    if kind == 4:
        return np.linalg.solve(CALIBRATIONS[4], wrench)[None]
    if kind == 5:
        return np.linalg.lstsq(CALIBRATIONS[5], wrench, rcond=None)[0][None]
    # Readings at four places whose sum and moment are the wrench (smallest such readings).
    readings = _readings_of_sensors() if kind == 6 else _unit_readings()
    columns = [np.concatenate([f, np.cross(r, f)]) for r, f in readings]
    found = np.linalg.lstsq(np.array(columns).T, wrench, rcond=None)[0]
    return (found if kind == 3 else np.linalg.solve(CALIBRATIONS[kind], found))[None]


def _readings_of_sensors():
    for place in SENSORS:
        for axis in np.eye(3):
            yield np.array([*place, 0.0]), axis


def _unit_readings():
    x, y, z = np.eye(3)
    yield np.array([0.0, B_MM, 0.0]), x
    yield np.array([0.0, -B_MM, 0.0]), x
    yield np.array([A_MM, 0.0, 0.0]), y
    yield np.array([-A_MM, 0.0, 0.0]), y
    for place in SENSORS:
        yield np.array([*place, 0.0]), z


def arrangement(kind: int, flipped: bool) -> tuple[tuple[float, ...], np.ndarray]:
    """ORIGIN as stored, and the vector from the transducers to the surface's centre in plate axes."""
    if kind in {3, 6, 7}:
        return (A_MM, B_MM, DEPTH_MM if flipped else -DEPTH_MM), np.array([0.0, 0.0, -DEPTH_MM])
    vector = np.array([3.0, -2.0, -DEPTH_MM])
    return tuple(-vector if flipped else vector), vector


@pytest.mark.slow
@pytest.mark.parametrize("kind", sorted(CHANNELS_OF_TYPE))
@pytest.mark.parametrize("flipped", [False, True])
@given(force=forces, place=places, torque=st.floats(-20000, 20000))
def test_wrench_of_each_type(kind, flipped, force, place, torque):
    world_force = np.array(force)
    F = PLATE_AXES.T @ world_force
    origin, vector = arrangement(kind, flipped)
    units = ("N",) * 3 + ("mm", "mm", "Nmm") if kind == 1 else ("V",) * CHANNELS_OF_TYPE[kind]
    readings = signals(kind, F, np.array(place), torque, vector)
    plate = plate_of(kind, readings, origin, units, calibration=CALIBRATIONS.get(kind))
    arm = PLATE_AXES @ np.array([*place, 0.0]) * 1e-3
    moment = np.cross(arm, world_force) + PLATE_AXES @ [0.0, 0.0, torque * 1e-3]
    check_geometry(plate, "file", "mm")
    found = wrench_at_surface(plate, "mm", []).wrench
    np.testing.assert_allclose(found, [np.concatenate([world_force, moment])], atol=1e-8)


@pytest.mark.parametrize(
    ("unit", "moment_unit", "factor"),
    [("mm", "Nmm", 1e-3), ("mm", "Nm", 1.0), ("mm", "N.m", 1.0), ("mm", "", 1e-3), ("m", "", 1.0),
     ("m", "N*mm", 1e-3), ("mm", "V", 1e-3), ("cm", "Ncm", 1e-2)],
)  # fmt: skip
def test_units_of_moments(unit, moment_unit, factor):
    readings = np.array([[0.0, 0.0, -100.0, 7.0, 0.0, 0.0]])
    plate = plate_of(2, readings, units=("N",) * 3 + (moment_unit,) * 3)
    np.testing.assert_allclose(
        wrench_at_surface(plate, unit, []).wrench[0, 3:], PLATE_AXES[:, 0] * 7.0 * factor, atol=1e-12
    )


def test_kilonewtons_are_newtons_times_a_thousand():
    plate = plate_of(2, np.array([[0.0, 0.0, -0.7, 0.002, 0.0, 0.0]]), units=("kN",) * 3 + ("kNm",) * 3)
    expected = np.concatenate([[0.0, 0.0, 700.0], 2.0 * PLATE_AXES[:, 0]])
    np.testing.assert_allclose(wrench_at_surface(plate, "mm", []).wrench[0], expected)


@pytest.mark.parametrize("kind", [3, 7])
def test_each_channel_of_four_sensors_pulls_where_they_stand(kind):
    """Fx12 Fx34 Fy14 Fy23 Fz1 … Fz4 of sensors at (+a +b), (−a +b), (−a −b), (+a −b), by hand; m, N m, plate axes."""
    a, b, depth = A_MM / 1e3, B_MM / 1e3, DEPTH_MM / 1e3
    expected = np.array(
        [
            [1, 0, 0, 0, depth, -b],
            [1, 0, 0, 0, depth, b],
            [0, 1, 0, -depth, 0, a],
            [0, 1, 0, -depth, 0, -a],
            [0, 0, 1, b, -a, 0],
            [0, 0, 1, b, a, 0],
            [0, 0, 1, -b, a, 0],
            [0, 0, 1, -b, -a, 0],
        ]
    )
    plate = plate_of(kind, np.eye(8), (A_MM, B_MM, -DEPTH_MM), ("N",) * 8, calibration=np.eye(8))
    found = wrench_at_surface(plate, "mm", []).wrench
    np.testing.assert_allclose(found[:, :3] @ PLATE_AXES, expected[:, :3], atol=1e-12)
    np.testing.assert_allclose(found[:, 3:] @ PLATE_AXES, expected[:, 3:], atol=1e-12)


def standing_readings(spread_mm: float) -> tuple[np.ndarray, np.ndarray]:
    """(S, 6) channels in N and N mm of a person who sways, and (S, 2) points of pressure, plate axes."""
    rng = np.random.default_rng(2)
    force = np.column_stack([rng.normal(0.0, 5.0, (60, 2)), rng.normal(700.0, 20.0, 60)])
    places = rng.uniform(-spread_mm, spread_mm, (60, 2))
    return np.hstack([force, np.cross(np.column_stack([places, np.zeros(60)]), force)]), places / 1e3


@pytest.mark.parametrize(("stored", "factor"), [(1.0, 1.0), (1e-3, 1e3), (1e3, 1e-3)])
def test_moments_in_another_unit_than_stated_are_recognised_by_the_pressure(stored, factor):
    readings, places_m = standing_readings(80.0)
    notes = []
    wrench = wrench_at_surface(plate_of(2, readings * [1, 1, 1, stored, stored, stored]), "mm", notes).wrench
    moment = wrench[:, 3:] @ PLATE_AXES
    pressed = np.column_stack([-moment[:, 1], moment[:, 0]]) / readings[:, 2:3]
    np.testing.assert_allclose(pressed, places_m, atol=1e-9)
    assert [f"taken {factor:g} times as large" in note for note in notes] == [True] * (factor != 1.0)


def test_axes_are_orthonormal_and_point_down_even_for_surveyed_corners():
    noisy = CORNERS_MM + np.random.default_rng(0).normal(0.0, 2.0, (3, 4))
    axes = plate_axes(noisy.T)
    np.testing.assert_allclose(axes.T @ axes, np.eye(3), atol=1e-12)
    np.testing.assert_allclose(axes, PLATE_AXES, atol=0.02)
    np.testing.assert_array_equal(plate_axes(CORNERS_MM.T), PLATE_AXES)


@pytest.mark.parametrize(
    ("plate", "reason"),
    [
        (plate_of(21, np.zeros((3, 8))), "type 21"),
        (plate_of(5, np.zeros((3, 8))), "type 5 without CAL_MATRIX"),
        (plate_of(7, np.zeros((3, 8)), calibration=np.eye(8)), "ORIGIN"),
        (plate_of(2, np.zeros((3, 5))), "needs 6 channels, it has 5"),
        (plate_of(2, np.zeros((3, 6)), corners=np.zeros((3, 4))), "no usable CORNERS"),
        (plate_of(2, np.zeros((3, 6)), corners=np.full((3, 4), np.nan)), "no usable CORNERS"),
        (plate_of(4, np.zeros((3, 6))), "CAL_MATRIX"),
        (plate_of(4, np.zeros((3, 6)), calibration=np.zeros((6, 6))), "CAL_MATRIX"),
        (plate_of(3, np.zeros((3, 8))), "ORIGIN"),
    ],
)
def test_unusable_plates_are_refused_with_what_is_missing(plate, reason):
    with pytest.raises(FileFormatError, match=reason):
        check_geometry(plate, "file", "mm")
