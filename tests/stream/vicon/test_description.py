"""Rate, names, axes and plates that DataStream's objects describe, and those that are left out."""

import struct

import numpy as np
import pytest

from mbkf.errors import InvalidInput
from mbkf.stream.vicon import objects
from mbkf.stream.vicon.description import TICKS_PER_S, describe
from tests.stream.vicon.test_objects import text

PERIOD = TICKS_PER_S // 100


def subject(number, name, *markers):
    listed = b"".join(struct.pack("<I", k) + text(one) for k, one in enumerate(markers))
    return struct.pack("<I", number) + text(name) + struct.pack("<2I", 0, len(markers)) + listed


def plate(device=7, place=(100.0, 200.0, 0.0), turn=None, bounds=(-300, -200, -40, 300, 200, 0)):
    rotation = np.eye(3) if turn is None else turn
    rest = (0.0, 0.0, -40.0, *np.eye(3).ravel())
    return struct.pack("<I30f", device, *place, *rotation.ravel(), *bounds, *rest)


def channel(device=7, names=("Fx", "Fy", "Fz")):
    return struct.pack("<2I", device, 1) + text("Force") + struct.pack("<I", 3) + b"".join(map(text, names))


def device(number=7, period=PERIOD):
    return struct.pack("<IQ", number, period) + text("Plate")


def known(**more):
    found = {
        objects.STREAM_INFO: [struct.pack("<q", PERIOD)],
        objects.SUBJECT_INFO: [subject(1, "Anna", "LASI", "RASI")],
        objects.DEVICE_INFO: [device()],
        objects.CHANNEL_INFO: [channel()],
        objects.PLATE_INFO: [plate()],
    }
    return found | {getattr(objects, name): value for name, value in more.items()}


def test_a_subject_and_a_plate():
    found = describe(known(), {7: 10}, None, None)
    assert (found.stream.trial, found.stream.marker_names) == ("Anna", ("LASI", "RASI"))
    assert (found.stream.rate_hz, found.stream.plate_rate_hz) == (100.0, 1000.0)
    assert found.places == {(1, 0): 0, (1, 1): 1} and not found.left_out
    corners = [[0.4, 0.4, 0.0], [-0.2, 0.4, 0.0], [-0.2, 0.0, 0.0], [0.4, 0.0, 0.0]]
    np.testing.assert_allclose(found.stream.plates[0].corners_m, corners, atol=1e-6)
    np.testing.assert_allclose(found.plates[0].sensor_m, [0.1, 0.2, -0.04], atol=1e-6)


def test_a_plate_whose_z_axis_points_down_has_its_upper_side_there():
    turned = np.diag([1.0, -1.0, -1.0])
    upper = known(PLATE_INFO=[plate(turn=turned, bounds=(-300, -200, 0, 300, 200, 40))])
    corners = describe(upper, {7: 10}, None, None).stream.plates[0].corners_m
    np.testing.assert_allclose(corners[:, 2], 0.0, atol=1e-6)


def test_bounds_axis_by_axis():
    by_axis = known(PLATE_INFO=[plate(bounds=(-300, 300, -200, 200, -40, 0))])
    np.testing.assert_allclose(
        describe(by_axis, {7: 10}, None, None).stream.plates[0].corners_m,
        describe(known(), {7: 10}, None, None).stream.plates[0].corners_m,
    )


def test_a_device_that_starts_later():
    found = describe(known(DEVICE_INFO_EXTRA=[struct.pack("<IQ", 7, PERIOD // 2)]), {7: 10}, None, None)
    assert found.stream.plates[0].start_time_s == pytest.approx(0.005)


def test_markers_of_one_name_are_told_apart_by_their_subject():
    both = known(SUBJECT_INFO=[subject(1, "Anna", "LASI", "RASI"), subject(2, "Ben", "LASI")])
    found = describe(both, {7: 10}, None, None)
    assert found.stream.marker_names == ("LASI", "RASI", "Ben:LASI") and found.places[2, 0] == 2
    chosen = describe(both, {7: 10}, None, "Ben")
    assert chosen.stream.marker_names == ("LASI",) and chosen.places == {(2, 0): 0}


def test_the_stated_axis_that_points_up():
    found = describe(known(APPLICATION_INFO=[b"\1"]), {}, None, None)
    np.testing.assert_allclose(found.rotation @ [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], atol=1e-12)
    np.testing.assert_array_equal(
        describe(known(APPLICATION_INFO=[b"\0"]), {}, None, None).rotation, np.eye(3)
    )


@pytest.mark.parametrize(
    ("forces", "changes", "words"),
    [
        ({}, {}, "sends no forces"),
        ({7: 10}, {"PLATE_INFO": [plate()[:-4], plate()[:50]]}, "cannot be read"),
        ({7: 10}, {"PLATE_INFO": [plate(turn=np.ones((3, 3)))]}, "no possible place"),
        ({7: 10}, {"PLATE_INFO": [plate(bounds=[0.0] * 6)]}, "no possible place"),
        (
            {7: 10, 8: 20},
            {
                "PLATE_INFO": [plate(), plate(8)],
                "DEVICE_INFO": [device(), device(8)],
                "CHANNEL_INFO": [channel(), channel(8)],
            },
            "another rate or start",
        ),
    ],
)
def test_plates_that_are_left_out_are_named(forces, changes, words):
    found = describe(known(**changes), forces, None, None)
    assert any(words in sentence for sentence in found.left_out), found.left_out


def test_a_device_without_forces_is_no_plate():
    found = describe(known(CHANNEL_INFO=[channel(names=("V1", "V2", "V3"))]), {7: 10}, None, None)
    assert not found.plates and not found.left_out


def test_without_a_rate_there_is_no_description():
    assert describe({}, {}, None, None) is None
    assert describe(known(STREAM_INFO=[struct.pack("<q", 0)]), {}, None, None) is None
    with pytest.raises(InvalidInput, match="frame rate is stated as"):
        describe(known(STREAM_INFO=[struct.pack("<q", 1)]), {}, None, None)


def test_more_markers_than_a_laboratory_has():
    many = known(SUBJECT_INFO=[subject(1, "Anna", *(f"m{k}" for k in range(5001)))])
    with pytest.raises(InvalidInput, match="5001 markers"):
        describe(many, {}, None, None)
