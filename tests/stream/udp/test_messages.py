"""Lines of JSON are read as the protocol's page states, and everything else is refused."""

import json

import numpy as np
import pytest

from mbkf.errors import InvalidInput, InvalidPacket, MbkfError
from mbkf.stream.source import UNCOUNTED
from mbkf.stream.udp.messages import described_again, described_fully, read_description, read_messages

CORNERS_MM = [[0, 0, 0], [400, 0, 0], [400, 0, -600], [0, 0, -600]]


def message(**fields):
    (found,) = read_messages(json.dumps(fields).encode())
    return found


def test_a_frame_holds_markers_points_and_samples():
    found = message(
        frame=7,
        markers={"A": [1, 2.5, 3], "B": None},
        points=[[1, 2, 3], [None, 2, 3]],
        sample=70,
        forces=[[[1, 2, 3, 4, 5, 6]], [[7, 8, 9, 1, 2, 3]]],
    )
    assert (found.number, found.sample, found.markers) == (7, 70, {"A": [1, 2.5, 3], "B": None})
    np.testing.assert_array_equal(found.points, [[1, 2, 3], [np.nan, 2, 3]])
    assert found.forces.shape == (2, 1, 6) and found.forces[1, 0, 2] == 9.0
    assert found.described == {}


def test_several_lines_stand_in_one_datagram():
    found = read_messages(b'{"frame": 1}\n\n{"rate": 100}\n')
    assert [one.number for one in found] == [1, None]
    assert found[1].described == {"rate": 100}


def test_empty_lists_are_no_points_and_no_samples():
    found = message(frame=1, points=[], forces=[])
    assert found.points.shape == (0, 3) and found.forces.shape == (0, 0, 6)


@pytest.mark.parametrize("number", [1e19, -1e300, float("nan"), float("inf")])
def test_a_count_that_cannot_be_is_none(number):
    assert message(frame=number).number == UNCOUNTED


@pytest.mark.parametrize(
    "line",
    [
        b"",
        b"\n \n",
        b"{",
        b"[1]",
        b"\xff\xfe",
        b"[" * 60_000,
        b'{"frame": ' + b"9" * 5000 + b"}",
        b'{"frame": "1"}',
        b'{"frame": true}',
        b'{"frame": 1, "markers": [[1, 2, 3]]}',
        b'{"frame": 1, "points": [[1, 2]]}',
        b'{"frame": 1, "points": [["a", 2, 3]]}',
        b'{"frame": 1, "points": {"A": 1}}',
        b'{"frame": 1, "forces": [[[1, 2, 3]]]}',
        b'{"frame": 1, "forces": [[[1, 2, 3, 4, 5, 6]], [[1]]]}',
        b'{"frame": 1, "sample": []}',
    ],
)
def test_anything_else_is_refused(line):
    with pytest.raises(InvalidPacket, match="UDP"):
        read_messages(line)


def test_a_description_becomes_metres_and_world_axes():
    """With y up, file −z is world y."""
    plate = {"name": "left", "corners": CORNERS_MM, "origin": [200, -5, -300], "rate": 1000}
    found = read_description(
        {"rate": 100, "unit": "mm", "moment_unit": "N mm", "up": "y", "names": ["A"], "plates": [plate]}
    )
    (read,) = found.stream.plates
    np.testing.assert_allclose(
        read.corners_m, [[0, 0, 0], [0.4, 0, 0], [0.4, 0.6, 0], [0, 0.6, 0]], atol=1e-12
    )
    np.testing.assert_allclose(read.origin_m, [0.2, 0.3, -0.005], atol=1e-12)
    assert (read.name, read.rate_hz, found.stream.rate_hz) == ("left", 1000.0, 100.0)
    assert (found.metres, found.newton_metres, found.stream.marker_names) == (1e-3, 1e-3, ("A",))


def test_what_is_not_stated_is_metres_z_up_and_the_middle_of_the_corners():
    corners = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
    found = read_description({"rate": 100, "plates": [{"corners": corners}, {}]})
    assert (found.metres, found.newton_metres) == (1.0, 1.0)
    np.testing.assert_array_equal(found.rotation, np.eye(3))
    first, second = found.stream.plates
    np.testing.assert_allclose(first.origin_m, [0.5, 0.5, 0])
    assert (first.name, second.name, first.rate_hz, second.corners_m) == ("1", "2", 100.0, None)


@pytest.mark.parametrize(
    ("fields", "words"),
    [
        ({}, "states no rate"),
        ({"rate": 0}, '"rate" is 0'),
        ({"rate": float("nan")}, '"rate" is nan'),
        ({"rate": "100"}, "'100'"),
        ({"unit": "parsec"}, "parsec"),
        ({"unit": 1}, '"unit" is not a text'),
        ({"moment_unit": "kg"}, "N mm"),
        ({"up": "w"}, "up axis"),
        ({"names": "A"}, '"names" is not a list'),
        ({"names": ["A", "A"]}, "twice"),
        ({"plates": [1]}, "plate 1 is not an object"),
        ({"plates": [{}] * 65}, "at most 64"),
        ({"plates": [{"corners": [[0, 0, 0]] * 4}]}, "no place"),
        ({"plates": [{"corners": [[0, 0]] * 4}]}, "plate 1"),
        ({"plates": [{"origin": [1e9, 0, 0]}]}, "no place"),
        ({"plates": [{"rate": 1000}, {"rate": 500}]}, "different rates"),
    ],
)
def test_a_description_that_cannot_be_is_refused_with_its_reason(fields, words):
    complete = {"rate": 100} | fields if fields else fields
    with pytest.raises(MbkfError, match=words):
        described_fully(complete, True)


@pytest.mark.parametrize("fields", [{"rate": [7] * 10_000}, {"rate": 100, "unit": "m" * 10_000}])
def test_a_refusal_does_not_repeat_a_long_value(fields):
    with pytest.raises(InvalidInput) as refused:
        read_description(fields)
    assert len(str(refused.value)) < 200


def test_keys_stay_until_they_are_sent_again():
    fields = {}
    assert described_again(fields, {"rate": 100, "unit": "m"})
    assert not described_again(fields, {"unit": "m"})
    assert described_again(fields, {"unit": "mm"})
    assert fields == {"rate": 100, "unit": "mm"}


def test_a_rate_is_waited_for():
    assert described_fully({}, False) is None
    assert described_fully({"rate": 50}, False).stream.rate_hz == 50.0
