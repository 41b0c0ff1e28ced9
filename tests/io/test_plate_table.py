"""Plates with corners: which axes, point, unit and sign the readings have follows from the centre of pressure."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.errors import FileFormatError, InvalidInput
from mbkf.io.axes import rotation_to_world
from mbkf.io.capture_options import CaptureOptions
from mbkf.io.plate_corners import plate_axes
from mbkf.io.plate_table import PlateTable, check_corners, faced_axis, plates_with_corners
from tests.io.true_capture import RATE_HZ, check_plates, made_plate, made_truth

TRUE = made_truth()


def table(
    plate, local=True, sign=1.0, factor=1.0, about_centre=True, described=True, pressure=True
) -> PlateTable:
    """A true plate as a file may hold it."""
    axes = plate_axes(plate.corners_m) if local else np.eye(3)
    middle = plate.corners_m.mean(axis=0)
    moment = plate.about_middle() if about_centre else plate.wrench[:, 3:]
    point = (plate.point_m - middle) @ axes if local else plate.point_m
    return PlateTable(
        "a.tsv",
        "1",
        plate.corners_m,
        sign * plate.force_n @ axes,
        sign * factor * moment @ axes,
        point if pressure else None,
        RATE_HZ,
        0.0,
        local if described else None,
    )


def read(tables, up="z", **options):
    return plates_with_corners(tables, up, CaptureOptions(**{"tare": False, **options}))


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("factor", [1.0, 1e3])
@pytest.mark.parametrize("described", [True, False])
@pytest.mark.parametrize(("local", "about_centre"), [(True, True), (False, True), (False, False)])
def test_what_a_file_does_not_say_follows_from_its_centres_of_pressure(
    sign, factor, described, local, about_centre
):
    tables = [table(plate, local, sign, factor, about_centre, described) for plate in TRUE.plates]
    check_plates(TRUE, read(tables))


@pytest.mark.parametrize("factor", [1.0, 1e3])
def test_without_a_centre_of_pressure_it_lies_on_the_plate(factor):
    check_plates(TRUE, read([table(plate, factor=factor, pressure=False) for plate in TRUE.plates]))


def test_rows_without_a_centre_of_pressure_do_not_count():
    one = table(TRUE.plates[0], local=False, described=False)
    pressure = np.array(one.pressure_m)
    pressure[30:60] = 0.0
    pressure[60:70] = np.nan
    check_plates(replace(TRUE, plates=TRUE.plates[:1]), read([replace(one, pressure_m=pressure)]))


def test_axes_that_nothing_tells_are_refused():
    plate = made_plate(0.0, 20, 180)
    at_origin = replace(
        plate, corners_m=plate.corners_m - [0.0, 0.2, 0.0], point_m=plate.point_m - [0.0, 0.2, 0.0]
    )
    with pytest.raises(
        FileFormatError, match="plate '1': its vectors fit plate and laboratory axes equally well"
    ):
        read([table(at_origin, described=False)])
    with pytest.raises(FileFormatError, match="plate '1': neither axes nor a centre of pressure"):
        read([table(plate, described=False, pressure=False)])


def test_a_plate_that_nobody_stood_on_follows_the_others():
    silent = table(TRUE.plates[1], sign=-1.0)
    silent = replace(silent, force_n=silent.force_n * 1e-4, moment=silent.moment * 1e-4)
    notes = []
    loaded, unloaded = read([table(TRUE.plates[0], sign=-1.0), silent], notes=notes)
    check_plates(replace(TRUE, plates=TRUE.plates[:1]), (loaded,))
    np.testing.assert_allclose(unloaded.force_n, 1e-4 * TRUE.plates[1].force_n, atol=1e-12)
    assert notes == ["the file holds the forces on the plates; turned into those on the body"]


def test_an_offset_is_removed_on_request():
    shifted = table(TRUE.plates[0], local=False)
    shifted = replace(shifted, force_n=shifted.force_n + np.array([0.0, 0.0, -15.0]))
    (plate,) = read([shifted], tare=True)
    assert plate.offset[2] == pytest.approx(-15.0)
    assert read([shifted])[0].force_n[0, 2] == pytest.approx(-15.0)


@pytest.mark.parametrize(
    ("up", "turn"), [("z", np.eye(3)), ("y", np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]]))]
)
def test_the_axis_that_a_plate_faces(up, turn):
    plate = table(TRUE.plates[0])
    assert faced_axis(replace(plate, corners_m=plate.corners_m @ turn.T)) == up


def test_vectors_keep_to_the_axes_they_are_read_with():
    notes = []
    plates = read([table(plate, sign=-1.0) for plate in TRUE.plates], up="y", notes=notes)
    turn = rotation_to_world("y")
    for truth, plate in zip(TRUE.plates, plates, strict=True):
        about_origin = plate.moment_nm + np.cross(plate.origin_m, plate.force_n)
        np.testing.assert_allclose(
            np.hstack([plate.force_n, about_origin]),
            np.hstack([truth.force_n @ turn.T, truth.wrench[:, 3:] @ turn.T]),
            atol=1e-6,
        )
        np.testing.assert_allclose(plate.corners_m, truth.corners_m @ turn.T)
    assert any("point along z of their file, which was read with y up" in note for note in notes)


def test_bad_plates_are_refused():
    plate = table(TRUE.plates[0])
    for corners in (np.zeros((4, 3)), np.full((4, 3), np.nan)):
        with pytest.raises(FileFormatError, match="plate '1' has no usable corners"):
            check_corners(replace(plate, corners_m=corners))
    force = np.array(plate.force_n)
    force[7, 0] = np.nan
    with pytest.raises(InvalidInput, match="plate '1': 1 of 300 samples"):
        read([replace(plate, force_n=force)])
    assert read([]) == ()
