"""Statics of synthetic persons, and trajectories in another order."""

from pathlib import Path

import numpy as np

from benchmarks.statics.captures import Static, with_order


def test_a_made_person_wears_the_protocol():
    markers, protocol = Static(Path(), "made plug_in_gait 4").load()
    assert protocol.name == "plug_in_gait"
    assert len(protocol.match(markers.names)) == len(markers.names)
    heights = dict(zip(markers.names, markers.positions_m[0, :, 2], strict=True))
    assert heights["RASI"] > heights["RKNE"] > heights["RANK"]


def test_columns_take_each_other_s_trajectories():
    markers, _ = Static(Path(), "made plug_in_gait 4").load()
    swapped = with_order(markers, [3, 5], [1, 0])
    assert np.array_equal(swapped.positions_m[:, [3, 5]], markers.positions_m[:, [5, 3]])
    assert swapped.names == markers.names
