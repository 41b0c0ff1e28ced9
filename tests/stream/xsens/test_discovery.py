"""A network streamer of MVN is found by listening, with segments or sensors and their rate."""

import itertools
import socket
from contextlib import closing

import pytest

from mbkf.stream import side_by_side
from mbkf.stream.xsens.discovery import xsens_streams
from mbkf.stream.xsens.source import XsensSource
from tests.stream.discovering import HERE
from tests.stream.xsens_datagrams import datagram, tracker, upright
from tests.waiting import repeating


def trackers(number):
    return datagram(number, kind=23, items=[tracker(one) for one in (1, 5, 7)])


@pytest.mark.parametrize(
    ("made", "contents"),
    [
        (upright, "2 segments at 100 Hz"),
        (trackers, "3 sensors at 100 Hz"),
        (lambda number: datagram(number, kind=13), "not known"),
    ],
    ids=["segments", "trackers", "other types"],
)
def test_a_streamer_is_heard(monkeypatch, made, contents):
    monkeypatch.setattr(side_by_side, "own_addresses", lambda local: [local])
    with closing(XsensSource(0, HERE)) as one:
        port = one.port
    counted = itertools.count()
    sender = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    with sender, repeating(lambda: sender.sendto(made(next(counted)), (HERE, port))):
        (found,) = xsens_streams(HERE, 30.0, port)
    assert (found.source, found.address, found.carries) == (f"xsens:{port}", HERE, contents)
    assert found.options == {"local": HERE}


def test_nothing_is_listed_where_nobody_sends_or_another_program_listens():
    with closing(XsensSource(0, HERE)) as other:
        assert xsens_streams(HERE, 0.0, other.port) == []
        port = other.port
    assert xsens_streams(HERE, 0.0, port) == []
