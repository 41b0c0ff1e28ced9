"""A buffer never grows, a patient one loses nothing, and threads that wait on it end."""

import threading

from mbkf.stream.receiving.ring_buffer import RingBuffer
from tests.waiting import PATIENCE_S


def test_the_latest_item_wins():
    buffer = RingBuffer(3)
    dropped = [buffer.put(k) for k in range(8)]
    assert [gone for gone in dropped if gone] == [[0, 1, 2], [3, 4, 5]]
    assert buffer.left() == [6, 7]
    assert [buffer.take(0.0) for _ in range(3)] == [6, 7, None]


def test_an_item_may_carry_those_that_it_overwrites():
    buffer = RingBuffer(2, joined=lambda gone, newest: (gone, newest))
    for k in range(5):
        buffer.put(k)
    assert buffer.left() == [([([0, 1], 2), 3], 4)]


def test_it_may_hold_more_for_a_while():
    buffer = RingBuffer(1)
    buffer.allow(3)
    assert [buffer.put(k) for k in range(3)] == [[], [], []]
    buffer.allow(1)
    assert buffer.put(3) == [0, 1, 2]


def test_items_that_come_at_once_are_held_until_the_first_of_them_is_too_old():
    buffer = RingBuffer(5, stale=lambda oldest, newest: newest - oldest >= 10)
    buffer.allow(2)
    assert [buffer.put(k) for k in (0, 1, 2, 3)] == [[], [], [], []]
    assert buffer.put(10) == [0, 1, 2, 3]
    assert [buffer.put(k) for k in (11, 12, 13, 14)] == [[], [], [], []]
    assert buffer.put(15) == [10, 11, 12, 13, 14]  # never more than at first


def test_a_patient_slot_keeps_the_giver_waiting():
    buffer, taken = RingBuffer(2, patient=True), []

    def give():
        for k in range(50):
            buffer.put(k)
        buffer.close()

    giver = threading.Thread(target=give)
    giver.start()
    while not buffer.ended:
        item = buffer.take(1.0)
        if item is not None:
            taken.append(item)
            assert len(buffer.left()) <= 2
    giver.join(PATIENCE_S)
    assert taken == list(range(50))


def test_closing_frees_whoever_waits():
    buffer = RingBuffer(1, patient=True)
    buffer.put(0)
    giver = threading.Thread(target=buffer.put, args=(1,))
    giver.start()
    buffer.close()
    giver.join(PATIENCE_S)
    assert not giver.is_alive()
    assert buffer.put(2) == []
    assert buffer.left() == [0, 1, 2]  # what came too late to be taken can still be counted
    assert [buffer.take(0.0) for _ in range(3)] == [0, 1, 2]
    assert buffer.ended
    assert buffer.take(1.0) is None
