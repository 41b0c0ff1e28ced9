"""Forces of plates in every convention become the force on the body about the plate's origin."""

import itertools

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from mbkf.stream.vicon.description import ViconPlate
from mbkf.stream.vicon.objects import MOST_SAMPLES, DeviceSamples
from mbkf.stream.vicon.plates import ORIGIN, SENSOR, PlateForceReader

TURN = Rotation.from_euler("zx", [30.0, 180.0], degrees=True).as_matrix()
ORIGIN_M, SENSOR_M = np.array([0.5, -0.2, 0.0]), np.array([0.5, -0.2, -0.05])
PLATE = ViconPlate(7, TURN, ORIGIN_M, SENSOR_M, 1_350_000, 2)
FORCE, PRESSURE, FREE = np.array([40.0, -20.0, 600.0]), np.array([0.62, -0.13, 0.0]), 5.0
WRENCH = np.hstack([FORCE, np.cross(PRESSURE - ORIGIN_M, FORCE) + np.array([0.0, 0.0, FREE])])


def sent(wrench=WRENCH, sign=1.0, newton_metres=1.0, metres=1.0, about=ORIGIN_M, frame=3):
    """Samples (2, 3) of force, moment and centre as a program states them."""
    moment = wrench[3:] + np.cross(ORIGIN_M - about, wrench[:3])
    own = (sign * wrench[:3], sign * moment / newton_metres, (PRESSURE - ORIGIN_M) / metres)
    return [[DeviceSamples(frame, 7, np.tile(one @ TURN, (2, 1)))] for one in own]


@pytest.mark.parametrize(
    ("sign", "newton_metres", "metres", "about"),
    [*itertools.product((1.0, -1.0), (1.0, 1e-3), (1.0, 1e-3), (ORIGIN, SENSOR))],
)
def test_every_convention_is_found_by_the_first_load(sign, newton_metres, metres, about):
    reader = PlateForceReader([PLATE])
    found = reader.samples(
        *sent(WRENCH, sign, newton_metres, metres, ORIGIN_M if about == ORIGIN else SENSOR_M)
    )
    assert found.index.tolist() == [6, 7]
    np.testing.assert_allclose(found.wrench[:, 0], np.tile(WRENCH, (2, 1)), rtol=1e-9)
    assert reader.convention.about == about and reader.convention.sign == sign
    assert about in reader.convention.sentence


def test_an_unloaded_plate_decides_nothing():
    reader = PlateForceReader([PLATE])
    quiet = reader.samples(*sent(0.05 * WRENCH, -1.0))
    assert reader.convention is None and not quiet.wrench.any()
    forces, moments, _ = sent(WRENCH, -1.0)
    assert np.isnan(reader.samples(forces, moments, []).wrench).all()
    reader.samples(*sent(WRENCH, -1.0))
    assert reader.convention.sign == -1.0


def test_the_first_load_counts_for_all_plates_of_its_packet():
    other = ViconPlate(8, TURN, ORIGIN_M, SENSOR_M, 1_350_000, 2)
    reader = PlateForceReader([PLATE, other])
    quiet, loaded = sent(0.05 * WRENCH, -1.0, 1e-3), sent(WRENCH, -1.0, 1e-3)
    both = [[one[0], DeviceSamples(3, 8, two[0].values)] for one, two in zip(quiet, loaded, strict=True)]
    found = reader.samples(*both)
    np.testing.assert_allclose(found.wrench, np.tile([0.05 * WRENCH, WRENCH], (2, 1, 1)), rtol=1e-9)


def test_samples_without_their_moments_or_of_other_devices_are_left_out():
    reader = PlateForceReader([PLATE])
    forces, moments, centres = sent()
    assert not len(reader.samples(forces, [], centres).index)
    other = [DeviceSamples(3, 9, forces[0].values)]
    assert not len(reader.samples(other, [DeviceSamples(3, 9, moments[0].values)], []).index)
    assert not len(reader.samples([DeviceSamples(2**32 - 1, 7, np.zeros((64, 3)))],
                                  [DeviceSamples(2**32 - 1, 7, np.zeros((64, 3)))], []).index)  # fmt: skip


def test_plates_whose_counts_have_nothing_in_common():
    reader = PlateForceReader([PLATE, ViconPlate(8, *[getattr(PLATE, name) for name in (
        "rotation", "origin_m", "sensor_m", "period", "samples")])])  # fmt: skip
    one, far = sent(), sent(frame=5000)
    forces = [*one[0], DeviceSamples(5000, 8, far[0][0].values)]
    moments = [*one[1], DeviceSamples(5000, 8, far[1][0].values)]
    found = reader.samples(forces, moments, one[2])
    assert found.index.tolist() == [6, 7] and np.isnan(found.wrench[:, 1]).all()


def test_a_packet_never_spans_more_samples_than_it_may_hold():
    apart = MOST_SAMPLES // 2 - 10
    values = [np.tile(FORCE, (apart, 1)), np.zeros((apart, 3))]
    forces, moments = ([DeviceSamples(k, 7, one) for k in (1, 3)] for one in values)
    found = PlateForceReader([PLATE]).samples(forces, moments, [])
    assert found.index.tolist() == list(range(apart, 2 * apart))
