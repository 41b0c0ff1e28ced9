"""Frames in which a person enters the volume are left out: once for each stretch, and for a second at most."""

import numpy as np
import pytest

from mbkf.io.records import MarkerTrajectories
from mbkf.trial.preparation.entering import without_entering

RATE_HZ, FEWEST, GAP_S, MARKERS = 50.0, 6, 0.2, 20


def trial(counts: list[int]) -> MarkerTrajectories:
    """A trial that shows the first so many of its markers in each frame."""
    positions = np.random.default_rng(1).normal(size=(len(counts), MARKERS, 3))
    for frame, count in zip(positions, counts, strict=True):
        frame[count:] = np.nan
    return MarkerTrajectories(tuple(f"M{k}" for k in range(MARKERS)), positions, RATE_HZ)


@pytest.mark.parametrize(
    ("counts", "entering"),
    [
        ([4, 7, 9, 10, 20, 8, 7, 3], (1, 2)),
        ([20] * 3 + [2] * 11 + [7, 9, 20], (14, 15)),
        ([20] * 3 + [2] * 10 + [7, 9, 20], ()),
        ([7] * 8 + [12] * 8, ()),
        ([9] * 50 + [20] * 4, range(50)),
        ([9] * 51 + [20] * 4, ()),
        ([3] * 5, ()),
    ],
    ids=["enters and leaves", "comes back", "short gap", "a part", "a second", "longer", "nobody"],
)
def test_frames_before_half_of_the_markers_are_seen_are_left_out(counts, entering):
    made = trial(counts)
    kept, notes = without_entering(made, FEWEST, GAP_S)
    right = made.positions_m.copy()
    right[list(entering)] = np.nan
    assert np.array_equal(kept.positions_m, right, equal_nan=True)
    assert len(notes) == bool(len(entering))
    if notes:
        assert f"in {len(entering)} frames (the last at {entering[-1] / RATE_HZ:.2f} s)" in notes[0]
