"""Labels of points of which nothing is known: each marker follows one point, on the segment that carries it."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.errors import InvalidInput
from mbkf.io.records import Capture, MarkerTrajectories
from mbkf.model.protocol import load_protocol
from mbkf.trial.label_nameless import label_nameless
from mbkf.trial.synth import synthesise

FRAMES = 200


@pytest.fixture(scope="module")
def walk():
    _, made = synthesise("walk", seed=3, seconds=3.0)
    markers = made.trial.markers
    return MarkerTrajectories(markers.names, markers.positions_m[:FRAMES], markers.rate_hz)


@pytest.fixture(scope="module")
def labelled(walk):
    rng = np.random.default_rng(8)
    order = rng.permutation(len(walk.names))
    points = walk.positions_m[:, order].copy()
    points[60:90, 4] = np.nan
    raw = MarkerTrajectories(tuple(f"*{i}" for i in range(len(order))), points, walk.rate_hz)
    found, person, inferred = label_nameless(Capture("", raw), mass_kg=75.0)
    away = np.linalg.norm(found.markers.positions_m[:, :, None] - walk.positions_m[:, None], axis=3)
    owner = np.where(np.isnan(away).all(axis=2), -1, np.nan_to_num(away, nan=np.inf).argmin(axis=2))
    return owner, person, inferred, found.markers.names


def test_a_marker_follows_one_point(labelled, walk):
    owner, _, _, names = labelled
    assert len(names) >= 0.95 * len(walk.names)
    for column in owner.T:
        assert len(np.unique(column[column >= 0])) == 1


def test_markers_are_on_the_segments_that_carry_them(labelled, walk):
    owner, _, inferred, names = labelled
    worn = load_protocol("reference36").match(walk.names)
    segment = {marker.name: marker.segment for marker in inferred.protocol.markers}
    right = [
        segment[name] == worn[walk.names[column.max()]].segment
        for name, column in zip(names, owner.T, strict=True)
    ]
    assert np.mean(right) >= 0.85


def test_names_tell_where_a_marker_is(labelled):
    _, _, inferred, names = labelled
    assert len(set(names)) == len(names)
    for marker in inferred.protocol.markers:
        assert marker.name == marker.landmark or marker.name.startswith(marker.segment)


def test_the_person_fits(labelled):
    _, person, _, _ = labelled
    assert person.mass_kg == 75.0
    assert person.report["marker_rms_mm"] < 10.0


def test_a_mass_is_needed(walk):
    with pytest.raises(InvalidInput, match="--mass"):
        label_nameless(replace(Capture("", walk), subject_mass_kg=None))
