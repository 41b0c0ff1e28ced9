"""Declared quantities: what a field states is what a record is held to."""

from dataclasses import dataclass

import numpy as np
import pytest

from mbkf.conventions import Array
from mbkf.errors import ShapeError
from mbkf.io.dimensions import ANGLE, METRE, ONE
from mbkf.io.quantities import (
    LATER,
    attribute,
    attributes,
    change,
    check,
    flag,
    offset,
    quantities,
    quantity,
    spread,
    texts,
)


@dataclass(frozen=True, kw_only=True)
class Record:
    times_s: Array = quantity("time", METRE, "times")
    dof_names: tuple[str, ...] = texts("dofs", axis="dof")
    plate_names: tuple[str, ...] = texts("plates", (), axis="plate")
    angle: Array = quantity("time dof", ANGLE, "angle")
    angle_sd: Array = spread("angle")
    angle_sd_offset: Array = offset("angle_sd")
    angle_sd_change: Array = change("angle_sd")
    seen: Array = flag("time", "seen")
    place_m: Array | None = quantity("plate xyz", METRE, "place", None, key="place")
    state: Array | None = quantity("time", ONE, "state", None, codes={0: "off", 1: "on"})
    later: Array = quantity("time dof xyz", ONE, "known later", LATER)
    title: str = attribute("title", "untitled")

    def __post_init__(self):
        check(self)


def made(**changes):
    values = {
        "times_s": [0.0, 1.0],
        "dof_names": ["a", "b", "c"],
        "angle": np.arange(6.0).reshape(2, 3),
        "angle_sd": np.ones((2, 3)),
        "seen": [1, 0],
    }
    return Record(**(values | changes))


def test_a_declaration_is_read_from_its_field():
    declared = quantities(Record)
    assert list(declared) == [name for name in Record.__dataclass_fields__ if name != "title"]
    assert declared["place_m"].key == "place" and declared["angle"].key == "angle"
    assert not declared["place_m"].required and declared["angle"].required
    assert declared["state"].dtype is np.int64 and declared["seen"].dtype is np.bool_
    assert [(one.name, one.read) for one in attributes(Record)] == [("title", str)]


def test_a_spread_has_axes_and_unit_of_its_array_and_its_parts_those_of_the_spread():
    declared = quantities(Record)
    for name in ("angle_sd", "angle_sd_offset", "angle_sd_change"):
        assert (declared[name].axes, declared[name].unit) == (("time", "dof"), ANGLE)


def test_arrays_are_read_only_and_of_their_type():
    r = made(state=np.array([0.0, 1.0]), place_m=np.zeros((1, 3)))
    assert (r.seen.dtype, r.state.dtype, r.times_s.dtype) == (np.bool_, np.int64, np.float64)
    assert not any(getattr(r, name).flags.writeable for name in ("times_s", "angle", "seen", "place_m"))
    assert r.dof_names == ("a", "b", "c")


def test_a_missing_part_is_0_where_the_spread_is_known():
    r = made(angle_sd=np.where(np.eye(2, 3) > 0, np.nan, 1.0))
    for part in (r.angle_sd_offset, r.angle_sd_change):
        np.testing.assert_array_equal(part, np.where(np.isnan(r.angle_sd), np.nan, 0.0))


def test_what_older_files_lack_is_unknown():
    assert made().later.shape == (2, 3, 3) and np.isnan(made().later).all()
    with pytest.raises(ShapeError, match=r"^later must have shape \(2, 3, 3\)"):
        made(later=np.zeros((2, 3)))


def test_missing_names_of_an_axis_are_numbers():
    assert made(place_m=np.zeros((2, 3))).plate_names == ("1", "2")
    assert made(place_m=np.zeros((2, 3)), plate_names=("x", "y")).plate_names == ("x", "y")
    assert made().plate_names == ()


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"angle": np.zeros((3, 3))}, r"^angle must have shape \(2, 3\)"),
        ({"angle": np.zeros(2)}, r"^angle must have shape \(2, 3\)"),
        ({"seen": [True]}, r"^seen must have shape \(2\)"),
        ({"place_m": np.zeros((2, 3)), "plate_names": ("1",)}, r"^place_m must have shape \(1, 3\)"),
        ({"place_m": np.zeros(2)}, r"^place_m must have shape \(2, 3\)"),
    ],
)
def test_sizes_that_differ_are_refused_by_name(changes, words):
    with pytest.raises(ShapeError, match=words):
        made(**changes)
