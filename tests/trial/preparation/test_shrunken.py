"""Clusters that shrink for a moment are left out; a walk's feet, which bend, stay."""

from dataclasses import replace

import numpy as np

from mbkf.trial.preparation.selection import subject_markers
from mbkf.trial.preparation.shrunken import BESIDE_S, without_shrunken
from tests.walker import walker


def test_a_walk_stays_as_it_is():
    made = walker()
    markers = subject_markers(made.trial.markers, made.subject)
    kept, notes = without_shrunken(markers, made.subject)
    assert notes == () and np.array_equal(kept.positions_m, markers.positions_m, equal_nan=True)


def test_a_mixture_is_left_out_with_the_frames_beside():
    made = walker()
    markers = subject_markers(made.trial.markers, made.subject)
    segment_of = {marker.name: marker.segment for marker in made.subject.markers}
    foot = [k for k, name in enumerate(markers.names) if segment_of[name] == "right_foot"]
    positions = markers.positions_m.copy()
    cluster = positions[30:36, foot]
    positions[30:36, foot] = 0.3 * cluster.mean(axis=1, keepdims=True) + 0.7 * cluster
    kept, (note,) = without_shrunken(replace(markers, positions_m=positions), made.subject)
    beside = round(BESIDE_S * markers.rate_hz)
    gone = np.zeros(markers.present.shape, dtype=bool)
    gone[30 - beside : 36 + beside, foot] = True
    assert np.array_equal(kept.present, markers.present & ~gone)
    assert note.startswith("the markers of the right foot") and "in 6 frames" in note


def test_key_points_of_20_mm_noise_stay():
    made = walker()
    markers = subject_markers(made.trial.markers, made.subject)
    noise = np.random.default_rng(3).normal(0.0, 0.02, markers.positions_m.shape)
    noisy = replace(markers, positions_m=markers.positions_m + noise)
    kept, notes = without_shrunken(noisy, made.subject)
    assert notes == () and np.array_equal(kept.positions_m, noisy.positions_m, equal_nan=True)
