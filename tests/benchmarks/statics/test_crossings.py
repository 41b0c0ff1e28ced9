"""Exchanges that statics are spoilt with."""

from benchmarks.statics.crossings import crossings
from mbkf.model.protocol import load_protocol

PROTOCOL = load_protocol("rajagopal_walk")
MARKERS = [one for one in PROTOCOL.markers if one.kind != "computed"]
NAMES = [one.name for one in MARKERS]
FOUND = crossings(PROTOCOL, MARKERS, seed=1)


def moved(order):
    return {NAMES[m] for m, one in enumerate(order) if one != m}


def test_pairs_are_those_of_the_landmarks():
    assert moved(FOUND["inner and outer knee"]) == {"R.Knee", "R.MKnee"}
    assert len(moved(FOUND["inner and outer knees"])) == 4


def test_sides_change_with_all_of_a_limb():
    legs = moved(FOUND["sides of legs"])
    assert {"R.TH1", "L.TH1", "R.Heel", "L.Toe"} <= legs and "R.ASIS" not in legs
    assert legs < moved(FOUND["sides of everything"])


def test_every_order_is_a_permutation_and_none_keeps_all():
    assert len(FOUND) >= 25
    for order in FOUND.values():
        assert sorted(order) == list(range(len(NAMES)))
        assert moved(order)
