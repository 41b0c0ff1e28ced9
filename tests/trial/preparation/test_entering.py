"""Frames in which a person enters the volume are left out where their markers lie off: a second at most, each time."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.trial.preparation.entering import without_entering
from mbkf.trial.preparation.selection import subject_markers
from tests.walker import walker

FEWEST, GAP_S, RATE_HZ = 6, 0.2, 50.0
OFF_M = 0.1
MIXED = np.random.default_rng(1).permutation(36)


def trial(counts, off_m=OFF_M, order=MIXED):
    """A walk that shows the first so many of its markers, in that order; 8 to 17 of 36 lie off by so much."""
    made = walker()
    markers = subject_markers(made.trial.markers, made.subject)
    positions = markers.positions_m[np.arange(len(counts))].copy()
    few = [8 <= count < 18 for count in counts]
    positions[few] += np.random.default_rng(2).normal(0.0, off_m, positions[few].shape)
    for frame, count in zip(positions, counts, strict=True):
        frame[order[count:]] = np.nan
    return replace(markers, positions_m=positions, rate_hz=RATE_HZ)


@pytest.mark.parametrize(
    ("counts", "entering"),
    [
        ([4, 9, 16, 18, 36, 14, 9, 3], (1, 2)),
        ([36] * 3 + [2] * 11 + [9, 16, 36], (14, 15)),
        ([36] * 3 + [2] * 10 + [9, 16, 36], ()),
        ([12] * 8 + [18] * 8, ()),
        ([16] * 50 + [36] * 4, range(50)),
        ([16] * 51 + [36] * 4, ()),
        ([3] * 5, ()),
    ],
    ids=["enters and leaves", "comes back", "short gap", "a part", "a second", "longer", "nobody"],
)
def test_frames_before_half_of_the_markers_are_seen_are_left_out(counts, entering):
    made = trial(counts)
    kept, notes = without_entering(made, walker().subject, FEWEST, GAP_S)
    right = made.positions_m.copy()
    right[list(entering)] = np.nan
    assert np.array_equal(kept.positions_m, right, equal_nan=True)
    assert len(notes) == bool(len(entering))
    if notes:
        assert f"in {len(entering)} frames (the last at {entering[-1] / RATE_HZ:.2f} s)" in notes[0]


@pytest.mark.parametrize("seen", ["legs", "trunk and arms", "anything"])
def test_first_frames_whose_markers_are_where_they_are_stay(seen):
    segments = {marker.name: marker.segment for marker in walker().subject.markers}
    names = subject_markers(walker().trial.markers, walker().subject).names
    legs = [segments[name].endswith(("thigh", "shank", "foot")) for name in names]
    first = {"legs": ~np.array(legs), "trunk and arms": np.array(legs), "anything": np.argsort(MIXED)}[seen]
    made = trial([16] * 20 + [36] * 10, 0.0, np.argsort(first, kind="stable"))
    kept, notes = without_entering(made, walker().subject, FEWEST, GAP_S)
    assert notes == () and np.array_equal(kept.positions_m, made.positions_m, equal_nan=True)
