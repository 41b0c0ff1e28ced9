"""A scaled subject found lying prone, from tracks, without a standing frame."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.labelling.assignment import HIDDEN
from mbkf.labelling.running import RunningSettings
from mbkf.labelling.tracks import link_tracks
from mbkf.trial.label import label
from mbkf.trial.labelling.any_attitude import AnyAttitude, name_tracks_of_frame
from mbkf.trial.labelling.body import label_body
from tests.labelling.movement import RATE_HZ, movement, shuffled
from tests.walker import walker

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def prone():
    """A subject, the capture of it crawling, shuffled, and the marker of every point."""
    subject = walker().subject
    body = label_body(subject.markers, subject, RunningSettings())
    rng = np.random.default_rng(2)
    points, marker = shuffled(movement(body.sensor, rng, frames=70), rng)
    names = tuple(f"*{k}" for k in range(points.shape[1]))
    markers = replace(walker().raw.markers, names=names, positions_m=points, rate_hz=RATE_HZ)
    return subject, body, replace(walker().raw, markers=markers, plates=()), marker


def test_tracks_are_named(prone):
    _, body, raw, marker = prone
    tracks = link_tracks(raw.markers.positions_m, RATE_HZ)
    owner, score = name_tracks_of_frame(body.sensor, body.search.sd_m, raw.markers.positions_m, tracks, 30)
    named = owner[tracks.number[30]]
    assert score > 0.0
    assert (named == marker[30]).mean() >= 0.9
    assert not ((named != marker[30]) & (named != HIDDEN)).any()


def test_starts_are_labelled_frames(prone):
    _, body, raw, marker = prone
    reported = []
    any_attitude = AnyAttitude(body.search, raw.markers.positions_m, RATE_HZ)
    found = any_attitude.starts([10, 40], lambda n, total: reported.append((n, total)))
    assert [t for t, _ in found] in ([10, 40], [40, 10])
    for t, first in found:
        assert np.array_equal(np.argsort(marker[t]), first.points)
    assert reported[0] == (0, 2)
    assert reported[-1] == (2, 2)
    assert found[0][1].log_ratio >= found[-1][1].log_ratio


def test_nothing_starts_where_nobody_is(prone):
    _, body, _, _ = prone
    points = np.random.default_rng(0).uniform(-1.0, 1.0, (20, 36, 3))
    assert AnyAttitude(body.search, points, RATE_HZ).at(5) is None


def test_label_announces_the_search_and_names_all(prone):
    subject, _, raw, marker = prone
    stages = []
    found = label(raw, subject, progress=lambda stage, *_: stages.append(stage))
    assert "Searching any attitude" in stages
    assert (found.label_of_point == marker).mean() >= 0.998
