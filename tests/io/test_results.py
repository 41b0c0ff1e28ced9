"""The result record: checked shapes, read-only arrays, access by name."""

import numpy as np
import pytest

from mbkf.errors import ShapeError, UnknownName
from mbkf.io.results import ARRAYS, SHAPES
from tests.io.reconstructions import made_up, made_up_whole


def test_every_array_is_read_only_and_has_its_shape_documented():
    r = made_up_whole()
    assert set(ARRAYS) == set(SHAPES)
    for name in ARRAYS:
        assert not getattr(r, name).flags.writeable
    assert r.tracked.dtype == bool
    assert r.nis_readings.dtype == np.int64
    assert r.foot_contact.dtype == np.int64
    assert r.frames == 12


@pytest.mark.parametrize("name", [name for name in ARRAYS if name not in ("times_s", "plate_corners_m")])
def test_a_wrong_shape_is_refused_by_name(name):
    r = made_up_whole()
    with pytest.raises(ShapeError, match=rf"^{name} must have shape \(12"):
        made_up(**{name: getattr(r, name)[:-1]})
    with pytest.raises(ShapeError, match=name):
        made_up(**{name: getattr(r, name)[..., None]})


def test_plates_have_four_corners():
    with pytest.raises(ShapeError, match=r"^plate_corners_m must have shape \(P, 4, 3\)"):
        made_up(plate_corners_m=made_up_whole().plate_corners_m[:, :3])


def test_values_come_by_name():
    r = made_up()
    np.testing.assert_array_equal(r.angle("hip_flexion_r"), r.angles[:, 2])
    np.testing.assert_array_equal(r.angle_sd("hip_flexion_r"), r.angles_sd[:, 2])
    np.testing.assert_array_equal(r.angle_rate("pelvis_tilt"), r.angle_rates[:, 0])
    np.testing.assert_array_equal(r.angle_rate_sd("pelvis_tilt"), r.angle_rates_sd[:, 0])
    np.testing.assert_array_equal(r.moment("pelvis_tx"), r.torque("pelvis_tx"))
    np.testing.assert_array_equal(r.moment_sd("pelvis_tx"), r.torque_sd("pelvis_tx"))
    np.testing.assert_array_equal(r.marker("B"), r.predicted_m[:, 1])


def test_a_lag_is_read_from_the_settings():
    assert made_up().lag_ms == 0.0
    assert made_up(settings={"lag_ms": 60.0}).lag_ms == 60.0


def test_a_wrong_name_is_answered_with_near_ones():
    r = made_up()
    with pytest.raises(UnknownName, match="did you mean hip_flexion_r"):
        r.angle("hip_flexion")
    with pytest.raises(UnknownName, match="unknown marker 'C'"):
        r.marker("C")


def test_present_leaves_out_hidden_and_missing_samples():
    measured, hidden = np.zeros((12, 2, 3)), np.zeros((12, 2), bool)
    measured[3, 0, 1], hidden[4, 1] = np.nan, True
    present = made_up(measured_m=measured, hidden=hidden).present
    assert np.argwhere(~present).tolist() == [[3, 0], [4, 1]]
