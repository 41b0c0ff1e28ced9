"""Work at several places runs at once; results keep their order."""

import threading

from mbkf.stream import side_by_side as module
from mbkf.stream.side_by_side import at_own_addresses, side_by_side


def test_places_are_worked_at_together_and_results_keep_their_order():
    together = threading.Barrier(3)

    def work(place):
        together.wait(30.0)
        return None if place == 1 else place

    assert side_by_side(work, [2, 1, 0]) == [2, 0] and side_by_side(work, []) == []


def test_each_own_address_is_listened_at_or_all_at_once(monkeypatch):
    monkeypatch.setattr(module, "own_addresses", lambda local: ["127.0.0.1", local])
    assert at_own_addresses(str, "10.0.0.1") == ["127.0.0.1", "10.0.0.1"]
    assert at_own_addresses(str, "0.0.0.0") == ["0.0.0.0"]
