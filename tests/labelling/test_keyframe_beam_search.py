"""A rough body matched with the tracks of a prone person: every marker on its own track, or on none."""

import numpy as np
import pytest

from mbkf.labelling.assignment import HIDDEN
from mbkf.labelling.keyframe_beam_search import search_keyframes
from mbkf.labelling.keyframes import choose_keyframes
from mbkf.labelling.skeleton import clusters
from mbkf.labelling.tracks import link_tracks
from mbkf.model.human import HumanModel
from mbkf.sensors.marker_sensor import MarkerSensor
from tests.labelling.bodies import reference_sensor
from tests.labelling.movement import RATE_HZ, movement, shuffled

pytestmark = pytest.mark.slow

ROUGH = reference_sensor("autolabel62")
BODY = clusters(ROUGH, np.full(len(ROUGH.segments), 0.03))


def person(rng, size):
    """A person of another size, whose clusters sit elsewhere on the segments than the protocol has them."""
    model = HumanModel.scaled({name: size for name in ROUGH.model.description.scale_factors})
    local = size * ROUGH.local_m + rng.normal(0.0, 0.006, ROUGH.local_m.shape)
    for segment in set(ROUGH.segments):
        local[np.array(ROUGH.segments) == segment] += rng.normal(0.0, 0.012, 3)
    return MarkerSensor(model, ROUGH.segments, local)


@pytest.mark.parametrize(("seed", "size"), [(1, 0.95)])
def test_a_prone_stranger_is_found(seed, size):
    rng = np.random.default_rng(seed)
    positions, marker = shuffled(movement(person(rng, size), rng), rng)
    tracks = link_tracks(positions, RATE_HZ)
    seen = choose_keyframes(positions, tracks, 70, 6)
    owner = np.empty(tracks.count, dtype=int)
    owner[tracks.number[70]] = marker[70]
    best, *others = search_keyframes(BODY, seen, 3)
    there = best.labels != HIDDEN
    right = owner[seen.tracks[best.labels[there]]] == np.flatnonzero(there)
    assert right.sum() >= 0.9 * len(there)
    assert right.mean() >= 0.98
    assert all(other.score <= best.score for other in others)
    assert len(set(best.labels[there].tolist())) == there.sum()


def test_points_of_no_person_make_no_body():
    rng = np.random.default_rng(0)
    drift = np.cumsum(rng.normal(0.0, 0.004, (120, 20, 3)), axis=0)
    positions = rng.uniform(-1.0, 1.0, (20, 3)) + drift
    seen = choose_keyframes(positions, link_tracks(positions, RATE_HZ), 60, 5)
    for body in search_keyframes(BODY, seen, 3):
        assert (body.labels != HIDDEN).sum() < 0.4 * len(body.labels)
