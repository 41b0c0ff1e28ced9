"""Where parts that may bear are, how they move, and what they are of."""

import numpy as np

from mbkf.sensors.supports.bearings import BearingParts
from tests.motions import central_difference, moderate_pose, random_model, reference_model

RNG = np.random.default_rng


def moved(seed):
    """A body of another size in some pose, with some velocity."""
    rng = RNG(seed)
    model = random_model(rng)
    return model, moderate_pose(model, rng), rng.normal(size=model.nv)


def test_parts_are_fixed_to_their_segments():
    model, q, v = moved(0)
    bearings = BearingParts(model)
    rotations, origins = model.placements(q)
    points = bearings.at(q, v).points_m
    assert points.shape == (len(bearings), 3)
    for k, one in enumerate(bearings.parts):
        joint = model.joint(one.segment).joint_id
        assert bearings.joint_ids[k] == joint
        size = model.axis_scale(model.description.segment(one.segment))
        np.testing.assert_allclose(
            rotations[joint].T @ (points[k] - origins[joint]), size * one.position_m, atol=1e-12
        )
        assert bearings.radii_m[k] == one.radius_m * size.mean()
        assert bearings.levers_m[k] == one.lever_m * size.mean()


def test_speeds_are_those_of_the_points():
    model, q, v = moved(1)
    bearings = BearingParts(model)
    by_q = central_difference(model, lambda at: bearings.at(at, v).points_m, q)
    np.testing.assert_allclose(bearings.at(q, v).speeds_m_s, np.linalg.norm(by_q @ v, axis=1), rtol=1e-6)


def test_a_body_at_rest_has_parts_at_rest():
    model, q, v = moved(2)
    np.testing.assert_array_equal(BearingParts(model).at(q, 0.0 * v).speeds_m_s, 0.0)


def test_left_parts_mirror_right_ones():
    """In a posture that is its own mirror image."""
    bearings = BearingParts(reference_model())
    q = reference_model().neutral()
    points = bearings.at(q, np.zeros(reference_model().nv)).points_m
    assert bearings.pairs
    for right, left in bearings.pairs:
        assert bearings.names[right].replace("right_", "left_") == bearings.names[left]
        np.testing.assert_allclose(points[left], points[right] * [1.0, -1.0, 1.0], atol=1e-9)
        assert points[right, 1] < points[left, 1]


def test_what_ends_a_limb_may_hold_and_what_is_on_the_root_may_sit():
    bearings = BearingParts(reference_model())
    holding = {name for name, grips in zip(bearings.names, bearings.grips, strict=True) if grips}
    assert holding == {"right_hand", "left_hand"}
    assert bearings.parts[bearings.seat].segment == reference_model().roles.root


def test_a_course_is_that_of_its_frames():
    model, q, v = moved(2)
    bearings, rng = BearingParts(model), RNG(3)
    qs = np.array([q, np.full(model.nq, np.nan), moderate_pose(model, rng)])
    vs = np.array([v, v, rng.normal(size=model.nv)])
    found = bearings.course(qs, vs)
    assert np.isnan(found.points_m[1]).all() and np.isnan(found.speeds_m_s[1]).all()
    for t in (0, 2):
        alone = bearings.at(qs[t], vs[t])
        np.testing.assert_allclose(found.points_m[t], alone.points_m, rtol=1e-13, atol=1e-14)
        np.testing.assert_allclose(found.speeds_m_s[t], alone.speeds_m_s, rtol=1e-12)
