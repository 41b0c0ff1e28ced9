"""Samples that MVN splits: joined in any order, given up where a part never comes."""

import numpy as np

from mbkf.stream.xsens.joining import MOST_WAITING, SampleJoiner
from mbkf.stream.xsens.packets import read_datagram
from tests.stream.xsens_datagrams import datagram, pose, tracker


def part(number, counter, segment, kind=2):
    item = pose(segment) if kind == 2 else tracker(segment)
    return read_datagram(datagram(number, kind=kind, counter=counter, items=[item]))


def test_a_sample_in_one_datagram_is_whole_at_once():
    found = SampleJoiner().put(part(3, 0x80, 5), 1.5)
    assert (found.number, found.time_ms, found.arrival_s, found.ids.tolist()) == (3, 30, 1.5, [5])
    assert found.values.shape == (1, 7)


def test_parts_in_any_order_make_a_sample_in_their_own():
    joiner = SampleJoiner()
    assert joiner.put(part(3, 0x82, 9), 0.0) is None
    assert joiner.put(part(4, 0x00, 1), 0.0) is None
    assert joiner.put(part(3, 0x00, 1), 0.0) is None
    assert joiner.put(part(3, 0x00, 1), 0.0) is None
    found = joiner.put(part(3, 0x01, 5), 0.1)
    assert found.ids.tolist() == [1, 5, 9] and found.arrival_s == 0.1


def test_samples_whose_parts_never_come_are_given_up():
    joiner = SampleJoiner()
    for number in range(MOST_WAITING + 3):
        assert joiner.put(part(number, 0x00, 1), 0.0) is None
    assert joiner.given_up == 3
    assert joiner.put(part(0, 0x81, 5), 0.0) is None
    assert joiner.put(part(MOST_WAITING + 2, 0x81, 5), 0.0).ids.tolist() == [1, 5]


def test_parts_of_another_layout_do_not_mix():
    joiner = SampleJoiner()
    joiner.put(part(1, 0x00, 1), 0.0)
    other = read_datagram(datagram(1, kind=23, counter=0x81, items=[tracker(5, more=tuple(np.zeros(9)))]))
    assert joiner.put(other, 0.0) is None
