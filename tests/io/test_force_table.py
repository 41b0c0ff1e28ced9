"""Tables of forces: what they do not state follows from weight, pushing plates and centres of pressure, or is told."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.errors import FileFormatError
from mbkf.io.axes import WORLD_AXES, rotation_to_world
from mbkf.io.capture_options import CaptureOptions
from mbkf.io.force_table import ForceTable, plates_of_table, vertical_axis
from tests.io.true_capture import RATE_HZ, check_plates, made_truth

TRUE = made_truth()
NAMES = [f"{kind}{axis}{k}" for k in (1, 2) for kind in ("F", "P", "M") for axis in "xyz"]


def table(up="z", sign=1.0, length=1.0, moment=1.0, about=None, **changes) -> ForceTable:
    """The truth in a file's axes and units; moments at the point of application, or about a point."""
    turn = rotation_to_world(up)
    columns = []
    for plate in TRUE.plates:
        torque = np.outer(plate.torque_nm, [0.0, 0.0, 1.0])
        if about is not None:
            torque = torque + np.cross(plate.point_m - about, plate.force_n)
        columns += [sign * plate.force_n @ turn, length * plate.point_m @ turn, sign * moment * torque @ turn]
    return replace(ForceTable("a.csv", tuple(NAMES), np.hstack(columns), RATE_HZ, 0.0), **changes)


def without(one: ForceTable, *names: str) -> ForceTable:
    kept = [i for i, name in enumerate(one.names) if name not in names]
    return replace(one, names=tuple(one.names[i] for i in kept), values=one.values[:, kept])


def read(one: ForceTable, up="z", notes=None):
    return plates_of_table(one, CaptureOptions(up=up, tare=False, notes=[] if notes is None else notes))


@pytest.mark.parametrize("up", WORLD_AXES)
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_axes_and_signs(up, sign):
    notes = []
    check_plates(TRUE, read(table(up, sign, on_body=False), up, notes))
    assert notes == ["the file holds the forces on the plates; turned into those on the body"] * (sign < 0.0)


@pytest.mark.parametrize("stored", WORLD_AXES)
@pytest.mark.parametrize("read_with", WORLD_AXES)
def test_vectors_keep_to_the_axes_they_are_read_with(stored, read_with):
    """Whatever is taken as up, the file's vectors are those of the truth; only weight decides what they mean."""
    notes = []
    one = table(stored, length=1e3, moment=1e3, metres=None, newton_metres=None, at_point=False)
    plates = read(one, read_with, notes)
    turn = rotation_to_world(read_with) @ rotation_to_world(stored).T
    for truth, plate in zip(TRUE.plates, plates, strict=True):
        about_origin = plate.moment_nm + np.cross(plate.origin_m, plate.force_n)
        np.testing.assert_allclose(plate.force_n, truth.force_n @ turn.T, atol=1e-6)
        np.testing.assert_allclose(about_origin, truth.wrench[:, 3:] @ turn.T, atol=1e-6)
    assert any("point along" in note for note in notes) == (stored != read_with)


@pytest.mark.parametrize("about", [None, [0.0, 0.0, 0.0], [0.35, 0.2, -0.04], [3.0, -1.0, 0.1]])
@pytest.mark.parametrize(("moment", "stated"), [(1.0, 1.0), (1.0, None), (1e3, None), (1e3, 1e-3)])
def test_the_point_and_the_unit_of_moments(about, moment, stated):
    one = table(moment=moment, about=about, newton_metres=stated, at_point=False)
    check_plates(TRUE, read(one))


@pytest.mark.parametrize(("length", "stated"), [(1.0, None), (1e3, None), (1e3, 1e-3)])
def test_the_unit_of_points(length, stated):
    notes = []
    check_plates(TRUE, read(table(length=length, metres=stated), notes=notes))
    assert any("taken as mm" in note for note in notes) == (stated is None and length > 1.0)


def test_a_set_with_moments_that_no_point_explains_is_left_out_or_refused():
    one, options = table(at_point=False), CaptureOptions(up="z", tare=False)
    values = np.array(one.values)
    values[:, 6] += 0.3 * values[:, 2] * np.sin(np.arange(len(values)))
    (other,) = plates_of_table(replace(one, values=values), options)
    assert other.name == "2" and "moments do not agree" in options.left_out["1"]
    alone = without(replace(one, values=values), *(name for name in one.names if name.endswith("2")))
    with pytest.raises(FileFormatError, match="set '1': moments do not agree"):
        read(alone)
    assert plates_of_table(alone, CaptureOptions(up="z", unneeded_plates=("1",))) == ()


@pytest.mark.parametrize("vertical", ["of all", "free"])
@pytest.mark.parametrize("up", ["y", "z"])
def test_torques_about_the_origin_that_should_act_at_the_point_are_moved_there(up, vertical):
    one, notes = table(up, about=np.zeros(3)), []
    if vertical == "free":
        values = np.array(one.values)
        column = "z" if up == "z" else "y"
        for k, plate in enumerate(TRUE.plates, start=1):
            values[:, one.names.index(f"M{column}{k}")] = plate.torque_nm
        one = replace(one, values=values)
    check_plates(TRUE, read(one, up, notes))
    assert len([note for note in notes if "moments refer to the laboratory's origin" in note]) == 2


def test_torques_at_a_point_beside_the_centre_of_pressure_stay_there():
    """A force and a torque at any point are one wrench; only torques about the origin contradict their point."""
    moved = table()
    values, arm, notes = np.array(moved.values), np.array([0.02, -0.03, 0.0]), []
    for k, plate in enumerate(TRUE.plates):
        loaded = plate.force_n[:, 2:] > 0.0
        values[:, 9 * k + 3 : 9 * k + 6] += loaded * arm
        values[:, 9 * k + 6 : 9 * k + 9] -= np.cross(arm, plate.force_n)
    read(replace(moved, values=values), notes=notes)
    assert not [note for note in notes if "refer to" in note]


def test_a_lone_moment_is_the_free_one_whatever_its_axis():
    for kept in ("Mz", "My"):
        one = without(table("y"), *(f"M{axis}{k}" for k in (1, 2) for axis in "xyz" if f"M{axis}" != kept))
        values = np.array(one.values)
        for k, plate in enumerate(TRUE.plates, start=1):
            values[:, one.names.index(f"{kept}{k}")] = plate.torque_nm
        check_plates(TRUE, read(replace(one, values=values), "y"))


def test_what_is_missing_is_told():
    notes = []
    plates = read(without(table(), *(f"M{axis}{k}" for k in (1, 2) for axis in "xyz")), notes=notes)
    assert [note for note in notes if "free moment is taken as 0" in note] == notes
    np.testing.assert_allclose(plates[0].force_n, TRUE.plates[0].force_n)
    notes = []
    check_plates(TRUE, read(without(table(), "Pz1", "Pz2"), notes=notes))
    assert [note for note in notes if "height of the point of application" in note] == notes


@pytest.mark.parametrize(
    ("names", "reason"),
    [
        (["Px1", "Py1", "Pz1"], "set '1' has no point of application"),
        (["Px1"], "lacks the x of its point of application, and z is up"),
        (["Px1", "Py1"], "column Px1 of set '1' is missing"),
        (["Mx2"], "column Mx2 of set '2' is missing"),
    ],
)
def test_what_cannot_be_completed_is_refused(names, reason):
    with pytest.raises(FileFormatError, match=reason):
        read(without(table(), *names))


def test_weight_tells_the_axis():
    for axis in WORLD_AXES:
        notes = []
        check_plates(TRUE, read(table(axis), None, notes))
        told = f"the ground reactions carry weight along {axis}; taken as up in their file (--up changes it)"
        assert notes == [told] * (axis != "y")
    check_plates(TRUE, read(table("z", -1.0, on_body=False), None))
    assert vertical_axis([np.zeros((5, 3))]) is None
    assert vertical_axis([np.tile([300.0, 0.0, 300.0], (5, 1))]) is None
