"""Names of tracks by the protocol alone: spreads, agreement of two outcomes, and the start they give."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.errors import NotObservable
from mbkf.labelling.assignment import HIDDEN
from mbkf.labelling.tracks import link_tracks
from mbkf.model.human import HumanModel
from mbkf.model.protocol import load_protocol
from mbkf.trial.labelling.track_naming import ROUGH_M, SAME_RATIO, NamedTracks, TrackNaming, _agree, _rough_sd
from tests.labelling.bodies import reference_sensor
from tests.walker import walker

PROTOCOL = load_protocol("reference36")


def named(owner, log_ratio=100.0):
    return NamedTracks(walker().subject, np.array(owner), log_ratio)


def test_outcomes_agree_on_the_tracks_that_both_name():
    one = named([0, 1, HIDDEN])
    assert _agree(one, named([0, 1, 2]))
    assert not _agree(one, named([0, 2, HIDDEN]))
    assert not _agree(one, None)
    assert _agree(one, named([0, 1, HIDDEN], 100.0 / SAME_RATIO - 1e-6))
    assert not _agree(one, named([0, 1, HIDDEN], 100.0 / SAME_RATIO + 1e-3))


def test_markers_far_from_the_middle_of_their_cluster_are_less_certain():
    sensor = reference_sensor()
    spread, segments = _rough_sd(sensor), np.array(sensor.segments)
    assert (spread >= ROUGH_M).all()
    own = np.flatnonzero(segments == "pelvis")
    arm = np.linalg.norm(sensor.local_m[own] - sensor.local_m[own].mean(axis=0), axis=1)
    assert np.array_equal(np.argsort(spread[own]), np.argsort(arm))
    alone = np.array([np.count_nonzero(segments == segment) == 1 for segment in segments])
    np.testing.assert_allclose(spread[alone], ROUGH_M)


def test_the_start_is_the_frame_with_most_named_markers_in_its_pose():
    made = walker()
    markers = made.trial.markers
    own = [markers.names.index(marker.name) for marker in PROTOCOL.markers]
    positions = markers.positions_m[:, own].copy()
    positions[:20, 3] = positions[21:, 5] = np.nan
    trial = replace(made.trial, markers=replace(markers, names=tuple("abcdefghi" * 4), positions_m=positions))
    tracks = link_tracks(positions, markers.rate_hz)
    owner = np.full(tracks.count, HIDDEN)
    for marker in range(positions.shape[1]):
        owner[np.unique(tracks.number[~np.isnan(positions[:, marker, 0]), marker])] = marker
    subject = replace(made.subject, markers=tuple(made.subject.markers))
    start = TrackNaming(trial, tracks, PROTOCOL, 70.0, None).start(NamedTracks(subject, owner, 1.0))
    assert start.frame == 20
    moved = HumanModel.of(subject).difference(made.truth.q[20], start.q)
    assert np.abs(moved[:3]).max() < 0.02
    assert np.abs(moved[3:6]).max() < 0.1


def test_points_at_random_are_refused():
    made = walker()
    rng = np.random.default_rng(0)
    positions = rng.uniform(-1.0, 1.0, (20, 3)) + np.cumsum(rng.normal(0.0, 0.004, (30, 20, 3)), axis=0)
    names = tuple(f"*{k}" for k in range(20))
    markers = replace(made.raw.markers, names=names, positions_m=positions)
    tracks = link_tracks(positions, markers.rate_hz)
    naming = TrackNaming(replace(made.raw, markers=markers), tracks, PROTOCOL, 70.0, 1.8)
    with pytest.raises(
        NotObservable, match=r"do not fit a person with the 36 markers of 'reference36'.*--subject"
    ):
        naming.best(lambda *_: None)
