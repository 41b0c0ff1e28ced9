"""Names that only the body's posture tells apart."""

import numpy as np
import pytest

from mbkf.labelling.first_frame import FirstFrameSearch
from mbkf.labelling.neighbours import exchanged, renamed
from mbkf.labelling.tracklets import link_points
from mbkf.model.protocol import load_protocol
from tests.labelling.bodies import posture, reference_sensor

NAMES = [m.name for m in load_protocol("oxford_biomechzoo").markers if m.kind != "computed"]


@pytest.fixture(scope="module")
def walk():
    """A search, and twenty frames of markers (T, M, 3) with their poses."""
    sensor, rng = reference_sensor("oxford_biomechzoo"), np.random.default_rng(2)
    search = FirstFrameSearch(sensor, np.full(len(NAMES), 0.010))
    first = posture(sensor.model, rng, swing_rad=0.2)
    step = 0.005 * rng.normal(size=sensor.model.nv)
    q = [sensor.model.integrate(first, k * step) for k in range(20)]
    markers = np.array([sensor.positions(pose) for pose in q])
    return search, markers + rng.normal(0.0, 0.001, markers.shape), np.array(q)


def test_right_names_stay(walk):
    search, markers, q = walk
    assert renamed(search, markers, q).tolist() == list(range(len(NAMES)))
    tracklets = link_points(markers)
    label = tracklets.number[0].copy()
    assert exchanged(search, markers, q, label, tracklets).tolist() == label.tolist()


def test_a_marker_that_was_not_worn_gives_its_name_back(walk):
    search, markers, q = walk
    shown = markers.copy()
    old, new = NAMES.index("RPCA"), NAMES.index("RSTL")
    shown[:, old], shown[:, new] = markers[:, new], np.nan  # under its neighbour's name
    name = renamed(search, shown, q)
    assert name[old] == new
    others = np.setdiff1d(np.arange(len(NAMES)), [old])
    assert (name[others] == others).all()


@pytest.mark.parametrize("side", ["R", "L"])
def test_exchanged_markers_of_a_wrist_turn_the_forearm_the_other_way(walk, side):
    search, markers, q = walk
    tracklets = link_points(markers)
    label = tracklets.number[0].copy()
    pair = [NAMES.index(f"{side}WRA"), NAMES.index(f"{side}WRB")]
    label[pair] = label[pair[::-1]]
    shown = markers.copy()
    shown[:, pair] = markers[:, pair[::-1]]
    assert exchanged(search, shown, q, label, tracklets).tolist() == list(range(len(NAMES)))


def test_a_body_that_was_never_followed_changes_nothing(walk):
    search, markers, q = walk
    lost = np.full_like(q, np.nan)
    tracklets = link_points(markers)
    label = tracklets.number[0].copy()
    assert renamed(search, markers, lost).tolist() == list(range(len(NAMES)))
    assert exchanged(search, markers, lost, label, tracklets).tolist() == label.tolist()
