"""Axes are proper rotations, units are what they say, and impossible bodies are refused."""

import numpy as np
import pytest

from mbkf.errors import InvalidInput, UnknownName
from mbkf.io.axes import (
    WORLD_AXES,
    axes_matrix,
    axes_text,
    body_extent_m,
    check_body_size,
    length_unit,
    nearest_axis,
    positions_to_world,
    rotation_to_world,
    up_axis,
)


@pytest.mark.parametrize("up", WORLD_AXES)
def test_up_of_the_file_becomes_z_by_a_proper_rotation(up):
    R = rotation_to_world(up)
    np.testing.assert_array_equal(R @ R.T, np.eye(3))
    assert np.linalg.det(R) == pytest.approx(1.0)
    direction = np.zeros(3)
    direction["xyz".index(up[-1])] = -1.0 if up.startswith("-") else 1.0
    np.testing.assert_array_equal(R @ direction, [0.0, 0.0, 1.0])


def test_opensim_axes_keep_forward_and_turn_right_into_minus_y():
    np.testing.assert_array_equal(rotation_to_world("y") @ [1.0, 2.0, 3.0], [1.0, -3.0, 2.0])


def test_names_of_axes_and_units_are_read_generously_and_unknown_ones_refused():
    assert (up_axis("+Y"), up_axis(" -Z ")) == ("y", "-z")
    assert (length_unit(" MM "), length_unit("Meters")) == ("mm", "m")
    assert [length_unit(cut) for cut in ("mete", "metr", "Mill", "centi")] == ["m", "m", "mm", "cm"]
    with pytest.raises(UnknownName, match="up axis 'w'"):
        up_axis("w")
    with pytest.raises(UnknownName, match="length unit 'furlong'"):
        length_unit("furlong")


def test_zero_nan_and_absent_samples_are_missing():
    values = np.array([[[0.0, 0.0, 0.0], [np.nan, 1.0, 1.0], [0.0, 0.0, 5.0], [1.0, 2.0, 3.0]]])
    present = np.array([[True, True, True, False]])
    result = positions_to_world(values, present, "y", "cm")
    assert np.isnan(result[0, [0, 1, 3]]).all()
    np.testing.assert_allclose(result[0, 2], [0.0, -0.05, 0.0])


def person(height_m: float) -> np.ndarray:
    rng = np.random.default_rng(1)
    return rng.uniform(0.0, 1.0, (50, 30, 3)) * [0.2, 0.2, height_m]


@pytest.mark.parametrize(("factor", "possible"), [(1.0, True), (1000.0, False), (1e-3, False), (0.1, False)])
def test_wrong_unit_is_noticed_from_the_size_of_the_body(factor, possible):
    if possible:
        assert check_body_size(person(1.7) * factor, "m", "file") == ()
    else:
        with pytest.raises(InvalidInput, match="--unit"):
            check_body_size(person(1.7) * factor, "m", "file")


def test_several_metres_at_once_are_remarked():
    (remark,) = check_body_size(person(15.0), "m", "file")
    assert "several people" in remark


def test_a_single_ghost_far_away_does_not_change_the_size():
    points = person(1.7)
    with_ghost = np.concatenate([points, np.full((50, 1, 3), 90.0)], axis=1)
    assert body_extent_m(with_ghost) == pytest.approx(body_extent_m(points), rel=0.15)


def test_size_is_the_median_over_frames_of_the_longest_side_without_outermost_tenths():
    points = np.full((4, 11, 3), np.nan)
    for frame, seen in enumerate((11, 9, 4, 3)):  # three markers show no size
        points[frame, :seen] = np.outer(np.arange(seen), (0.1, 0.2, 1.0))
    assert [body_extent_m(points[[frame]]) for frame in range(3)] == pytest.approx([8.0, 8.0, 3.0])
    assert np.isnan(body_extent_m(points[[3]]))
    assert body_extent_m(points) == pytest.approx(8.0)
    points[0, 0, 1] = np.nan  # a marker without one coordinate is not seen: ten are left
    assert body_extent_m(points[[0]]) == pytest.approx(7.2)


def test_size_of_nothing_is_unknown_and_accepted():
    assert np.isnan(body_extent_m(np.full((3, 8, 3), np.nan)))
    assert np.isnan(body_extent_m(np.zeros((0, 8, 3))))
    assert check_body_size(np.full((3, 8, 3), np.nan), "m", "file") == ()


@pytest.mark.parametrize("up", WORLD_AXES)
def test_three_axes_are_written_as_they_are_read(up):
    R = rotation_to_world(up)
    np.testing.assert_array_equal(axes_matrix(axes_text(R)), R)
    assert axes_text(R).split(",")[2] == up


def test_left_handed_axes_mirror():
    np.testing.assert_array_equal(axes_matrix(" X, +z ,y") @ [1.0, 2.0, 3.0], [1.0, 3.0, 2.0])
    assert np.linalg.det(axes_matrix("x,z,y")) == pytest.approx(-1.0)
    assert np.linalg.det(axes_matrix("x,-z,y")) == pytest.approx(1.0)


@pytest.mark.parametrize("axes", ["x,y", "x,y,y", "x,y,-x", "x,y,w", "", "x,y,z,x"])
def test_what_is_no_three_axes_is_refused(axes):
    with pytest.raises(InvalidInput, match="forward, left and up"):
        axes_matrix(axes)


def test_the_nearest_axis_has_the_sign_of_the_direction():
    assert nearest_axis(np.array([0.1, -0.9, 0.2])) == "-y"
