"""A subject's markers on the body: places follow the posture where displacements are known, and are fixed elsewhere."""

import numpy as np
import pytest

from mbkf.io.subject import SubjectMarker
from mbkf.sensors.flexed_skin import FlexedSkin
from mbkf.sensors.marker_sensor import MarkerSensor
from mbkf.sensors.subject_sensor import FlexedMarkerSensor, subject_sensor
from tests.motions import assert_near, moderate_pose, protocol_sensor, random_model


def worn(seed=3, size_m=0.012, slid=0.0):
    """A random body, a pose, and the protocol's markers with displacements by flexion of this spread."""
    rng = np.random.default_rng(seed)
    model = random_model(rng)
    sensor, names = protocol_sensor(model)
    flexions = FlexedSkin(model, sensor.segments).flexions
    markers = [
        SubjectMarker(
            name,
            segment,
            place,
            0.005,
            0.01,
            slides_m=rng.normal(0.0, size_m, (flexions, 3)),
            slid=np.full(flexions, slid),
        )
        for name, segment, place in zip(names, sensor.segments, sensor.local_m, strict=True)
    ]
    return model, moderate_pose(model, rng, spread=0.8), markers


def rigid(model, markers):
    return MarkerSensor(model, [m.segment for m in markers], np.array([m.position_m for m in markers]))


def test_a_marker_is_displaced_in_its_segment_by_the_flexions_beside_it(either_kernel):
    model, q, markers = worn()
    sensor, fixed = subject_sensor(model, markers), rigid(model, markers)
    shares = FlexedSkin(model, sensor.segments).shares(q)
    moved = np.array([share @ marker.slides_m for share, marker in zip(shares, markers, strict=True)])
    assert np.abs(moved).max() > 0.01
    assert_near(sensor.local_at(q), fixed.local_m + moved, 1e-15)
    axes = model.placements(q)[0][sensor.joint_ids]
    expected = fixed.positions(q) + np.einsum("mij,mj->mi", axes, moved)
    assert_near(sensor.positions(q), expected, 1e-13)
    reading = sensor.reading(q)
    np.testing.assert_array_equal(reading.positions_m, sensor.positions(q))
    held = MarkerSensor(model, sensor.segments, sensor.local_at(q)).reading(q)
    assert_near(reading.jacobian, held.jacobian, 1e-13)


def test_displacements_of_zero_change_no_bit(either_kernel):
    model, q, markers = worn(size_m=0.0)
    fixed = rigid(model, markers)
    flexed = FlexedMarkerSensor(model, fixed.segments, fixed.local_m, [m.slides_m for m in markers])
    for sensor in (flexed, subject_sensor(model, markers)):
        np.testing.assert_array_equal(sensor.positions(q), fixed.positions(q))
        np.testing.assert_array_equal(sensor.reading(q).jacobian, fixed.reading(q).jacobian)


def test_markers_corrected_on_a_trial_stay_in_its_usual_posture():
    model, q, markers = worn(slid=0.4)
    np.testing.assert_array_equal(
        subject_sensor(model, markers).positions(q), rigid(model, markers).positions(q)
    )


@pytest.mark.parametrize("rows", [0, 1])
def test_markers_with_fewer_displacements_move_by_those(rows):
    model, q, markers = worn()
    segments, places = [m.segment for m in markers], np.array([m.position_m for m in markers])
    few = FlexedMarkerSensor(
        model, segments, places, [m.slides_m[: rows if n == 0 else None] for n, m in enumerate(markers)]
    )
    shares = FlexedSkin(model, segments).shares(q)
    assert_near(few.local_at(q)[0] - places[0], shares[0, :rows] @ markers[0].slides_m[:rows], 1e-15)
    np.testing.assert_array_equal(few.local_at(q)[1:], subject_sensor(model, markers).local_at(q)[1:])
