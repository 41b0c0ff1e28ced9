"""Exchanges that are tried on a standing person."""

import numpy as np

from mbkf.model.protocol import load_protocol
from mbkf.scaling.exchange_candidates import Candidates, exchanged

PROTOCOL = load_protocol("rajagopal_walk")
NAMES = [marker.name for marker in PROTOCOL.markers]
SEEN = np.array([marker.kind != "computed" for marker in PROTOCOL.markers])
FOUND = Candidates(PROTOCOL.body, PROTOCOL.markers, SEEN)


def order(*pairs):
    return exchanged(len(NAMES), [(NAMES.index(a), NAMES.index(b)) for a, b in pairs]).tolist()


def test_pairs_are_tried_alone_and_on_both_sides_alike():
    tried = FOUND.pairs.tolist()
    assert order(("R.Knee", "R.MKnee")) in tried
    assert order(("R.Knee", "R.MKnee"), ("L.Knee", "L.MKnee")) in tried
    assert order(("R.Knee", "L.Knee")) in tried
    assert len({tuple(one) for one in tried}) == len(tried)


def test_technical_markers_of_a_segment_keep_their_names():
    assert order(("R.TH1", "R.TH2")) not in FOUND.pairs.tolist()


def test_pairs_of_arms_are_fitted_in_any_case():
    arms = [one.tolist() for one in FOUND.arms]
    assert order(("R.Elbow", "R.MElbow"), ("L.Elbow", "L.MElbow")) in arms
    assert order(("R.Knee", "R.MKnee")) not in arms


def test_limbs_change_sides_with_all_that_hangs_on_them():
    limbs = [{NAMES[m] for m in np.flatnonzero(one != np.arange(len(NAMES)))} for one in FOUND.limbs]
    shank = next(one for one in limbs if "R.SH1" in one and "R.Heel" in one and "R.TH1" not in one)
    assert {"L.SH1", "L.Ankle", "L.Toe"} <= shank
    assert any({"R.ASIS", "R.Elbow", "R.Heel"} <= one for one in limbs)
    assert any({"R.ASIS", "R.Heel"} <= one and "R.Elbow" not in one for one in limbs)


def test_markers_that_are_not_seen_keep_their_names():
    seen = SEEN & (np.array(NAMES) != "L.Knee")
    found = Candidates(PROTOCOL.body, PROTOCOL.markers, seen)
    every = np.concatenate([found.pairs, found.limbs])
    knees = [NAMES.index("L.Knee"), NAMES.index("R.Knee")]
    assert (every[:, knees[0]] == knees[0]).all()
    assert all(knees not in map(list, [pair]) for pair in found.sides)
