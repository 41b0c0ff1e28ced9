"""The parts of the first frame: clusters, roots, placed segments, partial and whole bodies."""

import numpy as np

from mbkf.labelling.assignment import HIDDEN
from mbkf.labelling.beam import PartialBody
from mbkf.labelling.beam_search import search_bodies, search_limb
from mbkf.labelling.placing import log_likelihood_ratio, match, placings
from mbkf.labelling.seeds import seeds_in_any_attitude, upright_seeds
from mbkf.labelling.skeleton import clusters, limbs
from tests.labelling.bodies import posture, reference_sensor, unlabelled

SENSOR = reference_sensor()
BODY = clusters(SENSOR, np.full(len(SENSOR.segments), 0.008))


def scene(seed=1, missing=0, extra=4, yaw=1.0):
    rng = np.random.default_rng(seed)
    q = posture(SENSOR.model, rng, 0.15, yaw)
    rotations, origins = SENSOR.model.placements(q)
    joints = [SENSOR.model.joint(cluster.segment).joint_id for cluster in BODY]
    return unlabelled(SENSOR.positions(q), rng, missing, extra), rotations[joints], origins[joints]


def test_clusters_hold_every_marker_once_and_rebuild_the_body():
    held = np.concatenate([cluster.markers for cluster in BODY])
    assert sorted(held) == list(range(len(SENSOR.segments)))
    _, rotations, origins = scene()
    for number, cluster in enumerate(BODY[1:], start=1):
        assert cluster.parent < number
        placed = origins[cluster.parent] + rotations[cluster.parent] @ cluster.origin_m
        assert np.allclose(placed, origins[number])


def test_limbs_reach_to_the_ends():
    found = {limb[0].segment: {cluster.segment for cluster in limb} for limb in limbs(BODY)}
    assert found["right_thigh"] == {"right_thigh", "right_shank", "right_foot", "right_toes"}
    assert "pelvis" not in found


def test_seeds_hold_the_true_root():
    frame, rotations, origins = scene()
    for seeds in (upright_seeds(BODY[0], frame.points), seeds_in_any_attitude(BODY[0], frame.points)):
        turn = np.linalg.norm(seeds[0] - rotations[0], axis=(1, 2))
        away = np.linalg.norm(seeds[1] - origins[0], axis=1)
        assert ((turn < 0.2) & (away < 0.03)).any()


def test_upright_seeds_stand():
    frame, _, _ = scene()
    rotations, _ = upright_seeds(BODY[0], frame.points)
    assert np.allclose(rotations[:, 2, 2], 1.0)
    assert np.allclose(rotations @ rotations.transpose(0, 2, 1), np.eye(3))


def test_a_segment_is_placed_on_its_points():
    frame, rotations, origins = scene()
    for number, cluster in enumerate(BODY):
        if len(cluster.markers) < 2 or number == 0:
            continue
        parent = rotations[cluster.parent]
        every = np.arange(len(frame.points))
        ways = placings(frame.points, cluster, origins[number], parent, every)
        own = frame.truth[cluster.markers]
        assert any(np.array_equal(way.labels, own) for way in ways), cluster.segment
        assert (ways[-1].labels == HIDDEN).all()
        scores = [way.score for way in ways[:-1]]
        assert scores == sorted(scores, reverse=True)


def test_a_point_matches_one_marker_of_a_cluster():
    placed = np.array([[[0.0, 0.0, 0.0], [0.02, 0.0, 0.0]]])
    matched, squared = match(placed, np.array([[0.005, 0.0, 0.0]]))
    assert matched.tolist() == [[0, HIDDEN]]
    assert np.allclose(squared, [[0.005**2, 0.0]])


def test_the_log_likelihood_ratio_prefers_sure_markers_and_near_points():
    sd = np.array([0.005, 0.05])
    assert log_likelihood_ratio(np.zeros(2), sd)[0] > log_likelihood_ratio(np.zeros(2), sd)[1]
    assert log_likelihood_ratio(np.full(2, 1e-4), sd)[0] < log_likelihood_ratio(np.zeros(2), sd)[0]


def test_the_best_body_is_the_true_one():
    frame, _, _ = scene()
    best, *rest = search_bodies(BODY, frame.points, upright_seeds(BODY[0], frame.points), 4)
    assert (best.labels == frame.truth).mean() >= 0.9
    assert all(one.score <= best.score for one in rest)
    used = best.labels[best.labels != HIDDEN]
    assert len(used) == len(set(used.tolist()))


def test_a_limb_grows_again_where_it_was():
    frame, rotations, origins = scene()
    limb = next(one for one in limbs(BODY) if one[0].segment == "left_shank")
    whole = PartialBody(rotations, origins, frame.truth, 0.0)
    again = search_limb(frame.points, whole, limb, 3)
    assert any(np.array_equal(one.labels, frame.truth) for one in again)


def test_nothing_grows_from_nothing():
    assert search_bodies(BODY, np.zeros((0, 3)), upright_seeds(BODY[0], np.zeros((0, 3))), 3) == []
