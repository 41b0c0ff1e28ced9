"""Parts of the beam searches: distinct labellings, triples of markers at equal distances, bodies that grow."""

from itertools import permutations

import numpy as np
import pytest

from mbkf.labelling.assignment import HIDDEN
from mbkf.labelling.beam import LIMBS, PartialBody, Placing, distinct_rows, extended_beam, matching_triples
from mbkf.labelling.skeleton import clusters
from tests.labelling.bodies import reference_sensor

SENSOR = reference_sensor()
BODY = clusters(SENSOR, np.full(len(SENSOR.segments), 0.01))


def test_rows_are_distinct_and_best_first():
    labels = np.array([[0, 1], [2, 3], [0, 1], [4, 5]])
    score = np.array([1.0, 2.0, 3.0, 0.5])
    assert distinct_rows(labels, score, 9) == [2, 1, 3]
    assert distinct_rows(labels, score, 2) == [2, 1]


@pytest.mark.parametrize("seed", range(3))
def test_triples_match_points_at_the_same_distances(seed):
    """Points are a triangle of markers, moved, and strangers: only the triangle's own order has its distances."""
    rng = np.random.default_rng(seed)
    local = np.array([[0.0, 0.0, 0.0], [0.2, 0.0, 0.0], [0.05, 0.13, 0.0]])
    points = np.concatenate(
        [local @ np.linalg.qr(rng.normal(size=(3, 3)))[0].T + 1.0, rng.uniform(3, 9, (4, 3))]
    )
    length = np.linalg.norm(points[:, None] - points, axis=2)
    found = [(tuple(three), chosen.tolist()) for three, chosen in matching_triples(local, length, 1e-9)]
    assert found == [((0, 1, 2), [[0, 1, 2]])]
    apart = np.ones((7, 7), dtype=bool)
    apart[0, 1] = apart[1, 0] = False
    assert list(matching_triples(local, length, 1e-9, apart)) == []


def test_triples_in_line_are_left_out():
    line = np.array([[0.0, 0.0, 0.0], [0.2, 0.0, 0.0], [0.4, 0.01, 0.0]])
    length = np.linalg.norm(line[:, None] - line, axis=2)
    assert list(matching_triples(line, length, 1.0)) == []


def test_a_body_grows_segment_by_segment():
    """Each way adds its score and takes its points; the joint is the parent's frame times the segment's origin."""
    root, turn = BODY[0], np.diag([-1.0, -1.0, 1.0])
    labels = np.arange(len(root.markers))
    body = PartialBody.of_root(BODY, Placing(turn, np.ones(3), labels, 2.0))
    np.testing.assert_array_equal(body.labels[root.markers], labels)
    assert (np.delete(body.labels, root.markers) == HIDDEN).all()
    asked = []

    def placings(cluster, origin, parent, free):
        asked.append((cluster.segment, origin, parent, free))
        for score, point in enumerate(free[:2]):
            own = np.full(len(cluster.markers), HIDDEN)
            own[:1] = point
            yield Placing(parent, origin, own, float(score))

    child = next(cluster for cluster in BODY if cluster.parent == 0 and len(cluster.markers))
    grown = extended_beam([body], [child], 100, placings)
    assert [one.score for one in grown] == [3.0, 2.0]
    ((segment, origin, parent, free),) = asked
    assert segment == child.segment
    np.testing.assert_allclose(origin, 1.0 + turn @ child.origin_m)
    np.testing.assert_array_equal(parent, turn)
    np.testing.assert_array_equal(free, np.arange(len(labels), 100))
    assert np.isnan(body.origins_m[child.number]).all()
    np.testing.assert_allclose(grown[0].origins_m[child.number], origin)


def test_fewer_bodies_are_kept_at_the_end_of_a_limb():
    body = PartialBody.of_root(
        BODY, Placing(np.eye(3), np.zeros(3), np.full(len(BODY[0].markers), HIDDEN), 0.0)
    )
    hand = next(cluster for cluster in BODY if cluster.ends and len(cluster.markers) >= 2)

    def placings(cluster, origin, parent, free):
        for pair in list(permutations(free, 2))[:60]:
            own = np.full(len(cluster.markers), HIDDEN)
            own[:2] = pair
            yield Placing(parent, origin, own, 0.0)

    parent = BODY[hand.parent]
    body.rotations[parent.number], body.origins_m[parent.number] = np.eye(3), 0.0
    assert len(extended_beam([body], [hand], 20, placings)) == LIMBS
