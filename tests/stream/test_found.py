"""A found stream says its contents, and the source that follows it."""

import pytest

from mbkf.stream.found import FoundStream
from mbkf.stream.played import played
from tests.captures import made_capture


@pytest.mark.parametrize(
    ("fields", "words"),
    [
        ((None, None, None), "not known"),
        ((36, 100.0, 2), "36 markers at 100 Hz, 2 plates"),
        ((36, None, 1), "36 markers, 1 plate"),
        ((None, 60.0, None, 15), "15 segments at 60 Hz"),
        ((None, None, None, 0, 17), "17 sensors"),
        ((0, 99.5, 0), "points without names at 99.5 Hz, no plates"),
    ],
)
def test_contents_in_words(fields, words):
    assert FoundStream("lsl", "a", "b", "", {}, *fields).carries == words


def test_contents_of_a_description():
    stream = played(made_capture(3)).stream
    found = FoundStream("udp", "a", "b", "15200", {"local": "x"})
    told = found.described(stream)
    assert (told.markers, told.rate_hz, told.plates) == (36, 100.0, 2)
    assert told.source == "udp:15200" and found.described(None) == found
