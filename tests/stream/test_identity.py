"""A stream that returns is the known one, in whatever order, or another one."""

from dataclasses import replace
from itertools import permutations

import numpy as np
import pytest

from mbkf.errors import InvalidInput
from mbkf.stream.identity import moved_counts, named_columns, plate_order, same_rate
from mbkf.stream.source import empty_plate

SQUARE = np.array([[0.6, 0.4, 0.0], [0.0, 0.4, 0.0], [0.0, 0.0, 0.0], [0.6, 0.0, 0.0]])


def plate(name, at=0.0, rate_hz=1000.0, corners=True):
    middle = np.array([0.3 + at, 0.2, -0.04])
    return empty_plate(
        name, rate_hz, 0.0, middle, 20.0, SQUARE + np.array([at, 0.0, 0.0]) if corners else None
    )


@pytest.mark.parametrize("order", list(permutations(range(3))))
def test_plates_in_any_order_are_found_by_where_they_lie(order):
    known = [plate("A"), plate("B", 0.7), plate("C", 1.4)]
    returned = [known[k] for k in order]
    assert [returned[k].name for k in plate_order(known, returned)] == ["A", "B", "C"]


def test_names_do_not_decide_where_geometry_does():
    """Plates that are named by their number have the same names after their order was reversed."""
    known = [plate("1"), plate("2", 0.7)]
    returned = [plate("1", 0.7), plate("2")]
    assert plate_order(known, returned).tolist() == [1, 0]


def test_names_decide_between_plates_of_unknown_geometry():
    known = [plate("A", corners=False), plate("B", corners=False)]
    assert plate_order(known, known[::-1]).tolist() == [1, 0]
    with pytest.raises(InvalidInput, match="'A'"):
        plate_order(known, [plate("C", corners=False), known[1]])


@pytest.mark.parametrize(
    ("returned", "reason"),
    [
        ([plate("A"), plate("B", 0.9)], "plate 'B' lies 200 mm from where it was"),
        ([plate("A"), plate("A")], "plate 'A' is not where it was"),
        ([plate("A")], "1 plates where 2 are known"),
        ([plate("A", rate_hz=2000.0), plate("B", 0.7, rate_hz=2000.0)], "another rate"),
        ([plate("A"), replace(plate("B", 0.7), corners_m=None)], "with other corners"),
        (
            [plate("A"), replace(plate("B", 0.7), corners_m=SQUARE[[1, 2, 3, 0]] + [0.7, 0, 0])],
            "other corners",
        ),
    ],
)
def test_other_plates_are_refused(returned, reason):
    with pytest.raises(InvalidInput, match=reason):
        plate_order([plate("A"), plate("B", 0.7)], returned)


def test_the_same_place_within_a_millimetre_is_the_same_plate():
    known = [plate("A"), plate("B", 0.7)]
    assert plate_order(known, [plate("B", 0.7004), plate("A", 0.0004)]).tolist() == [1, 0]


@pytest.mark.parametrize("order", list(permutations(range(3))))
def test_markers_in_any_order_are_found_by_name(order):
    known = ("A", "B", "C")
    returned = (*tuple(known[k] for k in order), "D")
    assert [returned[k] for k in named_columns("markers", known, returned)] == list(known)


@pytest.mark.parametrize(
    ("known", "found", "reason"),
    [
        (("A", "B"), ("A", "C"), r"other markers \(1 of 2 are missing: B\)"),
        (tuple("ABCDEF"), (), "6 of 6 are missing: A, B, C, D …"),
        ((), ("A",), "names where the points had none"),
        (("A", "B"), ("B", "A", "A"), "two markers 'A'"),
        (("A", "A", "B"), ("A", "B", "A"), "two markers 'A'"),
    ],
)
def test_other_markers_are_refused(known, found, reason):
    with pytest.raises(InvalidInput, match=reason):
        named_columns("markers", known, found)


def test_two_markers_of_one_name_are_known_by_their_order_alone():
    assert named_columns("markers", ("A", "A", "B"), ("A", "A", "B")).tolist() == [0, 1, 2]


def test_a_rate_is_the_same_within_rounding():
    same_rate(119.88, 119.880119)
    with pytest.raises(InvalidInput, match="it has 120 Hz"):
        same_rate(100.0, 120.0)


def test_counts_that_begin_at_another_time_are_moved():
    assert moved_counts(plate("A"), replace(plate("A"), start_time_s=0.25)) == 250
