"""A stream that is described anew keeps its markers by name and its plates by place; another one is refused."""

import numpy as np
import pytest

from mbkf.stream.known import KnownStream
from mbkf.stream.source import PlateSamples, StreamDescription, empty_plate


def plate(name, x):
    corners = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], dtype=float) + np.array([x, 0, 0])
    return empty_plate(name, 1000.0, 0.0, corners.mean(axis=0), 10.0, corners)


def described(names=("A", "B"), rate_hz=100.0, plates=()):
    return StreamDescription("x", names, rate_hz, 0.0, tuple(plates))


SAMPLES = PlateSamples(np.array([4]), np.arange(12.0).reshape(1, 2, 6))


def test_markers_are_found_by_name():
    known = KnownStream(described())
    np.testing.assert_array_equal(known.by_name({"A": [1, 2, 3], "B": None}), [[1, 2, 3], [np.nan] * 3])
    np.testing.assert_array_equal(known.by_name({"C": [9, 9, 9], "B": [1, 2, 3]}), [[np.nan] * 3, [1, 2, 3]])
    with pytest.raises(ValueError, match=r"broadcast|inhomogeneous|reshape"):
        known.by_name({"B": [1, 2]})


def test_another_order_is_followed():
    known = KnownStream(described())
    found = np.array([[1.0, 2, 3], [4, 5, 6]])
    assert known.in_order(found) is found
    assert known.describe(described(("B", "A"))) == []
    np.testing.assert_array_equal(known.in_order(found), found[::-1])


def test_a_marker_that_is_gone_is_missing_and_an_event():
    known = KnownStream(described())
    ((kind, sentence),) = known.describe(described(("B",)))
    assert (kind, "1 of 2" in sentence, known.refused) == ("markers", True, False)
    np.testing.assert_array_equal(known.in_order(np.array([[4.0, 5, 6]])), [[np.nan] * 3, [4, 5, 6]])


@pytest.mark.parametrize("other", [described(("C",)), described(rate_hz=50.0)])
def test_another_stream_is_refused_until_the_known_one_returns(other):
    known = KnownStream(described())
    assert known.describe(other)[0][0] == "refused" and known.refused
    assert known.describe(described()) == [] and not known.refused


def test_names_where_points_had_none_are_refused():
    known = KnownStream(described(()))
    assert known.describe(described(("A",)))[0][0] == "refused"


def test_plates_are_known_by_their_place():
    known = KnownStream(described(plates=[plate("1", 0.0), plate("2", 2.0)]))
    assert known.plate_samples(SAMPLES) is SAMPLES
    assert known.describe(described(plates=[plate("x", 2.0), plate("y", 0.0)])) == []
    np.testing.assert_array_equal(known.plate_samples(SAMPLES).wrench, SAMPLES.wrench[:, ::-1])


def test_a_plate_that_was_moved_is_not_read():
    known = KnownStream(described(plates=[plate("1", 0.0), plate("2", 2.0)]))
    ((kind, sentence),) = known.describe(described(plates=[plate("1", 0.3), plate("2", 2.0)]))
    assert kind == "plates refused" and "300 mm" in sentence
    found = known.plate_samples(SAMPLES).wrench
    assert np.isnan(found[:, 0]).all()
    np.testing.assert_array_equal(found[:, 1], SAMPLES.wrench[:, 1])


def test_plates_of_another_rate_are_not_read():
    known = KnownStream(described(plates=[plate("1", 0.0)]))
    other = empty_plate(
        "1", 500.0, 0.0, known.stream.plates[0].origin_m, 10.0, known.stream.plates[0].corners_m
    )
    assert "another rate" in known.describe(described(plates=[other]))[0][1]
    assert np.isnan(known.plate_samples(PlateSamples(np.array([4]), np.ones((1, 1, 6)))).wrench).all()


@pytest.mark.parametrize("one", [0.5, [0.5], "5", [1, 2], [1, 2, 3, 4], {}, [[[1]]]])
def test_a_marker_of_other_than_three_numbers_is_refused(one):
    known = KnownStream(described())
    with pytest.raises((ValueError, TypeError)):
        known.by_name({"B": one})
