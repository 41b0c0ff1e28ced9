"""The result record: checked shapes, read-only arrays, access by name."""

from typing import get_args

import numpy as np
import pytest

from mbkf.errors import ShapeError, UnknownName
from mbkf.io.results import ARRAYS, QUANTITIES, SdPart, varying_sd
from tests.io.reconstructions import made_up, made_up_whole, with_trunk


def test_every_array_is_read_only_and_has_its_shape_documented():
    r = made_up_whole()
    for name in ARRAYS:
        assert not getattr(r, name).flags.writeable
        assert len(QUANTITIES[name].axes) == getattr(r, name).ndim
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
    with pytest.raises(ShapeError, match=r"^plate_corners_m must have shape \(2, 4, 3\)"):
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


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({}, "causal (as live)"),
        ({"settings": {"lag_ms": 0.0}}, "causal (as live)"),
        ({"settings": {"lag_ms": 60.0}}, "fixed lag 60 ms"),
        ({"settings": {"lag_ms": 0.0}, "smoothed": True}, "smoothed (all later frames known)"),
        (
            {"smoothed": True, "uncorrected": 3},
            "smoothed (all later frames known), but 3 of 12 frames causal",
        ),
        ({"settings": {"lag_ms": 60.0}, "uncorrected": 1}, "fixed lag 60 ms, but 1 of 12 frames causal"),
    ],
)
def test_which_later_frames_an_estimate_knows_is_told_in_words(changes, told):
    assert made_up(**changes).later_frames == told


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


@pytest.mark.parametrize(
    ("read", "array"),
    [("angle_sd", "angles_sd"), ("angle_rate_sd", "angle_rates_sd"), ("moment_sd", "moments_sd")],
)
def test_what_varies_holds_the_filter_and_the_change_of_the_offset(read, array):
    """Without a change of the offset, as older files are, its square and the offset's are the total's."""
    total = np.abs(getattr(made_up(), array))
    for change in (0.0, 0.6):
        told = {array: total, f"{array}_offset": 0.6 * total, f"{array}_change": change * total}
        r = made_up(**told)
        parts = {part: getattr(r, read)("pelvis_tx", part) for part in get_args(SdPart)}
        np.testing.assert_array_equal(parts["total"], total[:, 1])
        np.testing.assert_allclose(parts["varying"] ** 2, (0.64 + change**2) * total[:, 1] ** 2, rtol=1e-6)
        np.testing.assert_allclose(parts["offset"], 0.6 * total[:, 1], rtol=1e-12)
        np.testing.assert_allclose(parts["change"], change * total[:, 1], rtol=1e-6)
    with pytest.raises(UnknownName, match="did you mean offset"):
        getattr(r, read)("pelvis_tx", "ofset")


def test_power_errs_as_a_product_of_independent_errors_does():
    """Moment and rate drawn about what is told: the product's scatter. All of its offset changes within a trial."""
    rng, name, draws = np.random.default_rng(3), "hip_flexion_r", 20000
    sd = {"angle_rates_sd": np.full((12, 3), 0.3), "moments_sd": np.full((12, 3), 2.0)}
    r = made_up(**sd, **{f"{array}_offset": 0.6 * total for array, total in sd.items()})
    m, rate = r.moment(name), r.angle_rate(name)
    np.testing.assert_array_equal(r.power(name), m * rate)
    for part, share in (("total", 1.0), ("offset", 0.6)):
        found = (m + share * 2.0 * rng.normal(size=(draws, 12))) * (
            rate + share * 0.3 * rng.normal(size=(draws, 12))
        )
        np.testing.assert_allclose(r.power_sd(name, part), found.std(axis=0), rtol=0.04)
    for part, same in (("varying", "total"), ("change", "offset")):
        np.testing.assert_array_equal(r.power_sd(name, part), r.power_sd(name, same))
    with pytest.raises(UnknownName, match="did you mean offset"):
        r.power_sd(name, "ofset")


def test_offsets_that_are_not_told_are_zero_where_the_total_is_known():
    total = made_up().sd_tau.copy()
    total[3] = np.nan
    r = made_up(sd_tau=total)
    assert np.isnan(r.sd_tau_offset[3]).all() and (r.sd_tau_offset[:3] == 0.0).all()
    assert r.foot_wrench_sd_offset is None
    np.testing.assert_array_equal(made_up_whole().foot_wrench_sd_offset, np.zeros((12, 2, 6)))


def test_rounding_never_makes_what_varies_imaginary():
    total, offset = np.array([5.0, 1.0]), np.array([4.0, 1.0 + 1e-12])
    np.testing.assert_array_equal(varying_sd(total, offset, np.zeros(2)), [3.0, 0.0])


def test_moments_of_the_trunk_are_read_by_level_turn_and_way():
    r = with_trunk()
    np.testing.assert_array_equal(r.trunk_moment("L5/S1"), r.trunk_moments[:, 0, 1, 0])
    np.testing.assert_array_equal(
        r.trunk_moment("T12/L1", "rotation", "bottom_up"), r.trunk_moments[:, 1, 0, 2]
    )
    np.testing.assert_array_equal(r.trunk_moment_sd("L5/S1", "bending"), r.trunk_moments_sd[:, 0, 1, 1])
    for wrong in (("L4/L5",), ("L5/S1", "flexion"), ("L5/S1", "bending", "sideways")):
        with pytest.raises(UnknownName):
            r.trunk_moment(*wrong)
    with pytest.raises(UnknownName):
        made_up().trunk_moment("L5/S1")


def test_results_without_moments_of_the_trunk_have_nan_at_their_levels():
    r = made_up(level_names=("L5/S1",))
    assert np.isnan(r.trunk_moment("L5/S1")).all() and np.isnan(r.trunk_moment_sd("L5/S1")).all()
