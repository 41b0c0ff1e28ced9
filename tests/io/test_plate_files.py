"""Every plate type in files of every processor and number format: force, moment and centre of pressure as applied."""

from itertools import product

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from mbkf.io.c3d import read_c3d
from mbkf.io.c3d_plates import CALIBRATION_OF_TYPE, CHANNELS_OF_TYPE
from mbkf.io.capture import read_capture
from mbkf.io.capture_options import CaptureOptions
from tests.io.c3d_builder import CENTRE_M, CORNERS_MM, PLATE_AXES, standing_points
from tests.io.c3d_bytes import DEC, INTEL, MIPS, c3d_bytes, floats, integers
from tests.io.test_c3d_plates import CALIBRATIONS, arrangement, signals

FRAMES, PER_FRAME = 40, 5
TURNS = [Rotation.from_euler("z", angle, degrees=True).as_matrix() for angle in (0.0, 90.0, 217.0)]
SHIFT_MM = np.array([300.0, -150.0, 40.0])
OFFSET = 500


def loads(samples, rng):
    """World force N, place on the surface mm in plate axes and free moment N mm; nothing at first and last."""
    force = np.array([0.0, 0.0, 700.0]) + rng.normal(0.0, 60.0, (samples, 3))
    place, torque = rng.uniform(-100.0, 100.0, (samples, 2)), rng.normal(0.0, 5000.0, samples)
    idle = (np.arange(samples) < 40) | (np.arange(samples) >= samples - 40)
    force[idle], torque[idle] = 0.0, 0.0
    return force, place, torque, ~idle


def plate_file(path, kind, turn=TURNS[0], processor=INTEL, whole=False, moments=1.0, flipped=False):
    """Writes a file; its moments are those of N mm times a factor, ORIGIN is of either sign."""
    rng = np.random.default_rng(kind)
    force, place, torque, loaded = loads(FRAMES * PER_FRAME, rng)
    axes, (origin, vector) = turn @ PLATE_AXES, arrangement(kind, flipped)
    rows = [signals(kind, axes.T @ F, p, m, vector)[0] for F, p, m in zip(force, place, torque, strict=True)]
    channels = np.array(rows)
    if kind == 1:
        channels[~loaded] = 0.0
    channels[:, 3:] *= moments
    gain = np.abs(channels).max(axis=0) / 30000.0 if whole else np.ones(channels.shape[1])
    corners = turn @ CORNERS_MM + SHIFT_MM[:, None]
    count = CHANNELS_OF_TYPE[kind]
    extra = [
        (4, "USED", 2, (), integers([1], processor)),
        (4, "TYPE", 2, (1,), integers([kind], processor)),
        (4, "CHANNEL", 2, (count, 1), integers(np.arange(1, count + 1), processor)),
        (4, "CORNERS", 4, (3, 4, 1), floats(corners.ravel(order="F"), processor)),
        (4, "ORIGIN", 4, (3, 1), floats(origin, processor)),
    ]
    if kind in CALIBRATION_OF_TYPE:
        matrix = CALIBRATIONS[kind]
        extra.append((4, "CAL_MATRIX", 4, (*matrix.shape, 1), floats(matrix.ravel(order="F"), processor)))
    path.write_bytes(
        c3d_bytes(
            standing_points(FRAMES, 6), channels.reshape(FRAMES, PER_FRAME, count), processor=processor,
            scale=0.1 if whole else None, gain=gain, offset=OFFSET, extra=tuple(extra),
        )
    )  # fmt: skip
    centre = corners.mean(axis=1) * 1e-3
    pressed = centre + np.hstack([place, np.zeros((len(place), 1))]) @ axes.T * 1e-3
    moment = np.cross(pressed - centre, force) + np.outer(torque * 1e-3, axes[:, 2])
    return force, moment, pressed, loaded


TYPES = sorted(CHANNELS_OF_TYPE)
FORMS = [*product((INTEL, DEC, MIPS), (False, True))]
PLATES = [
    *((kind, turn, INTEL, False) for kind in TYPES for turn in TURNS),
    *((kind, TURNS[2], *form) for kind in TYPES for form in FORMS[1:]),
]
"""Each type of plate in each direction, and in each form of numbers."""


@pytest.mark.parametrize(("kind", "turn", "processor", "whole"), PLATES)
def test_the_wrench_is_the_one_that_was_applied(tmp_path, kind, turn, processor, whole):
    path = tmp_path / "plate.c3d"
    force, moment, pressed, loaded = plate_file(path, kind, turn, processor, whole)
    (plate,) = read_c3d(path, CaptureOptions()).plates
    assert np.abs(plate.force_n - force).max() < 0.1
    assert np.abs(plate.moment_nm - moment).max() < 0.05
    assert np.linalg.norm(plate.centre_of_pressure_m - pressed, axis=1)[loaded].max() < 1e-4
    assert np.isnan(plate.centre_of_pressure_m[~loaded]).all()


@pytest.mark.parametrize(("moments", "factor"), [(1e-3, 1e3), (1e3, 1e-3)])
def test_moments_in_another_unit_are_known_by_where_they_press(tmp_path, moments, factor):
    path = tmp_path / "plate.c3d"
    _, moment, pressed, loaded = plate_file(path, 2, moments=moments)
    found = read_c3d(path, CaptureOptions())
    (plate,) = found.plates
    np.testing.assert_allclose(plate.moment_nm, moment, atol=0.05)
    assert np.linalg.norm(plate.centre_of_pressure_m - pressed, axis=1)[loaded].max() < 1e-4
    assert any(f"moments are taken {factor:g} times" in note for note in found.notes)


def test_moments_in_their_own_unit_are_left(tmp_path):
    path = tmp_path / "plate.c3d"
    plate_file(path, 2)
    assert not any("moments are taken" in note for note in read_c3d(path, CaptureOptions()).notes)


@pytest.mark.parametrize("kind", sorted(CHANNELS_OF_TYPE))
def test_either_sign_of_origin_presses_where_it_was_pressed_and_the_wrong_one_is_told(tmp_path, kind):
    path, told = tmp_path / "plate.c3d", "mm above the surface; it is taken with the opposite sign"
    places = []
    for flipped in (False, True):
        _, _, pressed, loaded = plate_file(path, kind, flipped=flipped)
        found = read_c3d(path, CaptureOptions())
        places.append(found.plates[0].centre_of_pressure_m[loaded])
        assert np.linalg.norm(places[-1] - pressed[loaded], axis=1).max() < 1e-4
        assert any(told in note for note in found.notes) is flipped
    assert np.linalg.norm(places[0] - places[1], axis=1).max() < 1e-4


def test_such_a_file_is_a_capture(tmp_path):
    plate_file(tmp_path / "plate.c3d", 6)
    found = read_capture(tmp_path / "plate.c3d")
    assert found.plates[0].rate_hz == 500.0 and found.up_axis == "z"
    np.testing.assert_allclose(found.plates[0].origin_m, CENTRE_M + SHIFT_MM * 1e-3, atol=1e-6)
