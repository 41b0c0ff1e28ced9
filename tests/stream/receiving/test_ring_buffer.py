"""A slot never grows, a patient one loses nothing, and threads that wait on it end."""

import threading

from mbkf.stream.receiving.ring_buffer import Slot


def test_the_latest_item_wins():
    slot = Slot(3)
    dropped = [slot.put(k) for k in range(8)]
    assert [gone for gone in dropped if gone] == [[0, 1, 2], [3, 4, 5]]
    assert slot.left() == [6, 7]
    assert [slot.take(0.0) for _ in range(3)] == [6, 7, None]


def test_it_may_hold_more_for_a_while():
    slot = Slot(1)
    slot.allow(3)
    assert [slot.put(k) for k in range(3)] == [[], [], []]
    slot.allow(1)
    assert slot.put(3) == [0, 1, 2]


def test_a_patient_slot_keeps_the_giver_waiting():
    slot, taken = Slot(2, patient=True), []

    def give():
        for k in range(50):
            slot.put(k)
        slot.close()

    giver = threading.Thread(target=give)
    giver.start()
    while not slot.ended:
        item = slot.take(1.0)
        if item is not None:
            taken.append(item)
            assert len(slot.left()) <= 2
    giver.join(1.0)
    assert taken == list(range(50))


def test_closing_frees_whoever_waits():
    slot = Slot(1, patient=True)
    slot.put(0)
    giver = threading.Thread(target=slot.put, args=(1,))
    giver.start()
    slot.close()
    giver.join(1.0)
    assert not giver.is_alive()
    assert slot.put(2) == []
    assert slot.take(0.0) == 0
    assert slot.ended
    assert slot.take(1.0) is None
