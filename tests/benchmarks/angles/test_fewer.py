"""Sets of fewer markers: named once, part of the full one, and cut out of a capture."""

import numpy as np

from benchmarks.angles.fewer import SETS, only
from mbkf.io.records import Capture, MarkerTrajectories


def test_the_sets_have_as_many_markers_as_they_say():
    assert len(set(SETS["legs only"])) == 15
    assert len(set(SETS["36 markers"])) == 36
    assert set(SETS["legs only"]) < set(SETS["36 markers"])


def test_a_cut_keeps_order_and_places():
    places = np.arange(18.0).reshape(2, 3, 3)
    capture = Capture("", MarkerTrajectories(("B", "A", "C"), places, 100.0))
    cut = only(capture, ("A", "B", "X"))
    assert cut.markers.names == ("B", "A")
    np.testing.assert_array_equal(cut.markers.positions_m, places[:, :2])
