"""The kernel's markers are those of the readable code, to rounding, wherever the body is and whichever are seen."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mbkf.kernel.loading import library
from mbkf.kernel.markers import innovations
from mbkf.sensors.marker_sensor import MarkerInformation
from tests.motions import moderate_pose, protocol_sensor, random_model, worst

pytestmark = pytest.mark.skipif(library() is None, reason="the kernel is not compiled here")

ROUNDING = 1e-12
often = settings(max_examples=25, deadline=None)
seeds = given(st.integers(0, 10**6))


def wearing(seed, off_m=1.0):
    """A random person with the protocol's markers somewhere in the world, and the generator."""
    rng = np.random.default_rng(seed)
    model = random_model(rng)
    sensor, _ = protocol_sensor(model)
    q = moderate_pose(model, rng)
    q[:3] += off_m * rng.normal(size=3)
    return rng, sensor, q


@often
@seeds
def test_places_are_those_on_the_segments_frames(seed):
    _, sensor, q = wearing(seed)
    frames, jacobian = sensor.model.frames_and_jacobian(q)
    expected = [
        np.append(own, 1.0) @ frames[4 * joint : 4 * joint + 4]
        for own, joint in zip(sensor.local_m, sensor.joint_ids, strict=True)
    ]
    places, found = sensor.compiled.places(q)
    assert worst(places - np.array(expected)) <= ROUNDING
    np.testing.assert_array_equal(found, jacobian)


@often
@given(st.integers(0, 10**6), st.sampled_from([1.0, 30.0]))
def test_information_is_that_of_the_trusted_markers(seed, off_m):
    """Also far from the world's origin, where moments about it would lose digits."""
    rng, sensor, q = wearing(seed, off_m)
    markers = len(sensor.segments)
    weights, trusted = rng.uniform(1e3, 1e6, markers), rng.random(markers) < rng.random()
    y = 0.01 * rng.normal(size=(markers, 3))
    y[~trusted] = np.nan
    reading = sensor.reading(q)
    matrix, vector, squared = sensor.compiled.information(
        weights, trusted, reading.spatial, reading.positions_m, y
    )
    H, counted = reading.jacobian, weights * trusted
    expected = np.einsum("mij,mik,m->jk", H, H, counted)
    forces = np.where(trusted[:, None], y, 0.0) * weights[:, None]
    assert worst(matrix - expected) <= ROUNDING * max(worst(expected), 1.0)
    np.testing.assert_array_equal(matrix, matrix.T)
    tolerance = off_m * ROUNDING * max(worst(forces), 1.0)
    assert worst(vector - np.einsum("mij,mi->j", reading.jacobian, forces)) <= tolerance
    assert squared == pytest.approx(np.sum(forces[trusted] * y[trusted]), rel=1e-12)


@pytest.mark.parametrize("scale", [0.3, 1.0, 7.0])
def test_the_noise_s_scale_divides_the_information(either_kernel, scale):
    rng, sensor, q = wearing(5)
    y, noise = 0.01 * rng.normal(size=(len(sensor.segments), 3)), np.full(len(sensor.segments), 0.004)
    trusted = np.ones(len(y), dtype=bool)
    of = MarkerInformation(sensor, noise)
    assert (sensor.compiled is None) == (either_kernel == "reference")
    found = of.at(sensor.reading(q), y, trusted, scale)
    plain = of.at(sensor.reading(q), y, trusted)
    assert worst(found.matrix * scale - plain.matrix) <= ROUNDING * worst(plain.matrix)
    assert worst(found.vector * scale - plain.vector) <= ROUNDING * worst(plain.vector)
    assert found.innovation * scale == pytest.approx(plain.innovation, rel=1e-12)


@often
@seeds
def test_innovations_tell_who_is_seen_and_whether_all_are_near(seed):
    rng = np.random.default_rng(seed)
    predicted, y = rng.normal(size=(9, 3)), 0.01 * rng.normal(size=(9, 3))
    y[rng.random(9) < 0.3, rng.integers(3)] = np.nan
    length = np.linalg.norm(y, axis=1)
    for radius in (0.5, 0.015, 0.001):
        found = innovations(predicted + y, predicted, radius)
        np.testing.assert_array_equal(found.seen, ~np.isnan(length))
        np.testing.assert_array_equal(found.innovation_m, predicted + y - predicted)
        assert worst(found.squared_m2 - np.nan_to_num(length) ** 2) <= ROUNDING
        assert found.near == bool((np.nan_to_num(length) <= radius).all())


@pytest.mark.usefixtures("reference_kernel")
def test_the_reference_has_no_compiled_markers():
    _, sensor, _ = wearing(2)
    assert sensor.compiled is None
    assert innovations(np.zeros((2, 3)), np.zeros((2, 3)), 1.0) is None
