"""A capture in other axes: forces turn as vectors, moments as pseudovectors, corners keep their order."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mbkf.errors import ShapeError
from mbkf.io.plate_corners import plate_normal
from mbkf.io.records import AxesSource, PlateReadings
from mbkf.io.turning import recentred, turned, turned_plate
from tests.captures import made_capture


def signed_permutations():
    def matrix(order, signs):
        return np.eye(3)[list(order)] * np.array(signs)[:, None]

    return st.builds(
        matrix, st.permutations(range(3)), st.lists(st.sampled_from([-1.0, 1.0]), min_size=3, max_size=3)
    )


def pressed_plate(corners: bool) -> PlateReadings:
    """A plate pressed at points of its surface with slanted forces and a free moment about its normal."""
    rng = np.random.default_rng(4)
    origin = np.array([0.3, -0.2, 0.0])
    force = rng.normal([0.0, 0.0, 600.0], 30.0, (50, 3))
    point = origin + rng.uniform(-0.15, 0.15, (50, 3)) * [1.0, 1.0, 0.0]
    free = rng.normal(0.0, 5.0, (50, 3)) * [0.0, 0.0, 1.0]
    moment = np.cross(point - origin, force) + free
    square = origin + 0.2 * np.array([[1.0, 1.0, 0.0], [1.0, -1.0, 0.0], [-1.0, -1.0, 0.0], [-1.0, 1.0, 0.0]])
    return PlateReadings("1", 1000.0, 0.0, origin, force, moment, point, 20.0, square if corners else None)


def free_moment(plate: PlateReadings) -> np.ndarray:
    """What remains of the moment at the centre of pressure."""
    return plate.moment_nm - np.cross(plate.centre_of_pressure_m - plate.origin_m, plate.force_n)


@settings(max_examples=48, deadline=None)
@given(signed_permutations(), st.booleans())
def test_moments_stay_levers_times_forces(turn, corners):
    """M = r × F + free moment about the surface's normal, r to the point that the record states."""
    after = turned_plate(pressed_plate(corners), turn)
    pressed = ~np.isnan(after.centre_of_pressure_m).any(axis=1)
    normal = plate_normal(after.corners_m) if corners else np.array([0.0, 0.0, 1.0])
    np.testing.assert_allclose(np.cross(free_moment(after)[pressed], normal), 0.0, atol=1e-9)
    heavy = (after.force_n[:, 2] >= after.threshold_n) & (
        after.force_n @ normal * np.sign(normal[2] or 1.0) > 0
    )
    np.testing.assert_array_equal(pressed, heavy)


@pytest.mark.parametrize("turn", [np.diag([1.0, -1.0, 1.0]), np.diag([-1.0, 1.0, 1.0]), np.eye(3)[[1, 0, 2]]])
def test_in_a_mirror_free_moments_turn_the_other_way(turn):
    before = pressed_plate(False)
    after = turned_plate(before, turn)
    np.testing.assert_allclose(after.centre_of_pressure_m, before.centre_of_pressure_m @ turn.T)
    np.testing.assert_allclose(free_moment(after)[:, 2], -free_moment(before)[:, 2], atol=1e-9)


@settings(max_examples=48, deadline=None)
@given(signed_permutations())
def test_a_wrench_does_the_same_work_in_the_mirror(turn):
    """Power F·v + M·ω, with the velocity of a vector and the turning velocity of a pseudovector."""
    rng = np.random.default_rng(5)
    velocity, turning = rng.normal(size=(2, 3))
    before = pressed_plate(False)
    after = turned_plate(before, turn)
    det = np.linalg.det(turn)
    power = before.force_n @ velocity + before.moment_nm @ turning
    np.testing.assert_allclose(
        after.force_n @ (turn @ velocity) + after.moment_nm @ (det * turn @ turning), power
    )


@settings(max_examples=48, deadline=None)
@given(signed_permutations(), st.booleans())
def test_there_and_back_is_the_same(turn, corners):
    capture = made_capture()
    if not corners:
        capture = replace(capture, plates=tuple(replace(p, corners_m=None) for p in capture.plates))
    back = turned(turned(capture, turn, AxesSource.BODY), turn.T, AxesSource.MADE)
    np.testing.assert_array_equal(back.markers.positions_m, capture.markers.positions_m)
    assert (back.axes, back.up_axis) == (capture.axes, capture.up_axis)
    for one, other in zip(capture.plates, back.plates, strict=True):
        np.testing.assert_allclose(other.force_n, one.force_n, atol=1e-9)
        np.testing.assert_allclose(other.centre_of_pressure_m, one.centre_of_pressure_m, atol=1e-12)
        np.testing.assert_array_equal(other.origin_m, one.origin_m)
        np.testing.assert_allclose(other.moment_nm, one.moment_nm, atol=1e-9)


def test_a_plate_with_corners_reads_in_its_own_axes():
    """A file mirrored along z: its corners lie where they were, in the same order, and so do the plate's readings."""
    before = pressed_plate(True)
    after = turned_plate(before, np.diag([1.0, 1.0, -1.0]))
    np.testing.assert_allclose(plate_normal(before.corners_m), [0.0, 0.0, 1.0])
    np.testing.assert_allclose(plate_normal(after.corners_m), [0.0, 0.0, 1.0])
    np.testing.assert_allclose(after.force_n, before.force_n)
    np.testing.assert_allclose(after.moment_nm, before.moment_nm)


def test_a_plate_mirrored_along_the_floor_faces_down():
    """The order of its corners says so; a person on it then seems to be pushed down, so such axes are wrong."""
    after = turned_plate(pressed_plate(True), np.diag([1.0, -1.0, 1.0]))
    np.testing.assert_allclose(plate_normal(after.corners_m), [0.0, 0.0, -1.0])
    assert (after.force_n[:, 2] < 0.0).all()
    np.testing.assert_allclose(after.force_n[:, 1], pressed_plate(True).force_n[:, 1] * -1.0)


def test_moments_are_about_the_mean_centre_of_pressure():
    before = pressed_plate(False)
    after = recentred(before)
    np.testing.assert_allclose(after.origin_m, before.centre_of_pressure_m.mean(axis=0))
    np.testing.assert_allclose(free_moment(after), free_moment(before), atol=1e-9)
    assert recentred(pressed_plate(True)).origin_m.tolist() == pressed_plate(True).origin_m.tolist()
    unloaded = replace(before, centre_of_pressure_m=np.full((50, 3), np.nan))
    assert recentred(unloaded) is unloaded


def test_offsets_of_a_misread_vertical_are_put_back():
    """An offset was taken for the horizontal; seen upright, the plate's own offset is found instead."""
    force = np.zeros((2000, 3))
    force[:, 2] = -12.0
    force[800:1200, 2] = 700.0
    wrong = np.array([0.0, 5.0, 0.0, 0.0, 0.0, 0.0])
    lying = PlateReadings(
        "1", 1000.0, 0.0, np.zeros(3), (force - wrong[:3]) @ np.array([[0, 0, 1.0], [1, 0, 0], [0, 1, 0]]).T,
        np.zeros((2000, 3)), np.full((2000, 3), np.nan), 20.0, offset=np.array([0.0, 0, 5, 0, 0, 0]),
    )  # fmt: skip
    after = turned_plate(lying, np.array([[0, 1.0, 0], [0, 0, 1], [1, 0, 0]]))
    np.testing.assert_allclose(after.offset, [0.0, 0.0, -12.0, 0.0, 0.0, 0.0], atol=1e-9)
    np.testing.assert_allclose(after.force_n[1000], [0.0, 0.0, 712.0], atol=1e-9)


@pytest.mark.parametrize("turn", [np.eye(2), 2.0 * np.eye(3), np.diag([1.0, 1.0, 0.0])])
def test_only_signed_permutations_turn(turn):
    with pytest.raises(ShapeError, match="signed permutation"):
        turned(made_capture(5), turn, AxesSource.BODY)


def test_axes_follow_the_turn():
    capture = turned(made_capture(5), np.array([[0.0, 0, 1], [1, 0, 0], [0, -1, 0]]), AxesSource.GIVEN)
    assert (capture.axes, capture.up_axis, capture.axes_source) == ("z,x,-y", "-y", AxesSource.GIVEN)
