"""A limb is fitted alone: to its own markers, within its ranges, from a start that is given."""

import numpy as np
import pytest

from mbkf.sensors.limb_fit import BEYOND_SD_RAD, LimbFits
from tests.motions import moderate_pose, protocol_sensor, reference_model

MODEL = reference_model()
SENSOR, _ = protocol_sensor(MODEL)
NOISE_M = 0.005
FITS = LimbFits(SENSOR, np.full(36, NOISE_M), np.zeros(MODEL.nv, dtype=bool))
LEG = next(one for one in FITS.limbs if one.name == "left_thigh")
K = FITS.limbs.index(LEG)


def bent(angle_rad, dof=1):
    """Standing with the left knee bent."""
    step = np.zeros(MODEL.nv)
    step[MODEL.joints["left_shank"].v.start + dof] = angle_rad
    return MODEL.integrate(MODEL.neutral(), step)


def test_a_limb_comes_back_and_the_rest_stays():
    q = moderate_pose(MODEL, np.random.default_rng(3), spread=0.2)
    moved = q.copy()
    step = np.zeros(MODEL.nv)
    step[LEG.dofs] = 0.2
    moved = MODEL.integrate(q, step)
    found = FITS.fit(LEG, moved, SENSOR.positions(q))
    apart = MODEL.difference(q, found.q)
    assert np.abs(apart[LEG.dofs]).max() < 0.03 and found.rms_m < 0.003
    others = np.setdiff1d(np.arange(MODEL.nv), LEG.dofs)
    np.testing.assert_allclose(apart[others], 0.0, atol=1e-12)


def test_one_stray_marker_does_not_draw_the_limb():
    q = bent(0.5)
    seen = SENSOR.positions(q)
    seen[np.flatnonzero(FITS.on_limb[K])[0]] += 0.5
    found = FITS.fit(LEG, q, seen)
    assert np.abs(MODEL.difference(q, found.q)).max() < 0.03


def test_cost_counts_fit_posture_and_ranges():
    q = bent(-np.radians(30.0))  # knees bend back by 10 at most
    seen = SENSOR.positions(q)
    found = FITS.judged(LEG, q, seen)
    beyond = np.radians(20.0)
    assert found.beyond_rad == pytest.approx(beyond) and found.rms_m == pytest.approx(0.0, abs=1e-12)
    sd = MODEL.posture_sd[MODEL.joints["left_shank"].v.start + 1]
    expected = (beyond / BEYOND_SD_RAD) ** 2 + (np.radians(30.0) / sd) ** 2
    assert found.cost == pytest.approx(expected)
    seen[FITS.on_limb[K]] += [0.0, 0.0, 0.01]
    count = FITS.on_limb[K].sum()
    assert FITS.judged(LEG, q, seen).cost == pytest.approx(expected + count * (0.01 / NOISE_M) ** 2)


def test_evidence_by_limb():
    q = bent(-np.radians(30.0))
    seen = SENSOR.positions(q)
    own = np.flatnonzero(FITS.on_limb[K])
    seen[own] += [0.03, 0.0, 0.0]
    seen[own[0]] = np.nan
    found = FITS.evidence(q, seen)
    assert found.seen[K] == len(own) - 1
    assert found.misfit_m[K] == pytest.approx(0.03) and found.segment_m[K] == pytest.approx(0.03)
    assert found.others_m[K] == pytest.approx(0.0, abs=1e-12)
    assert found.beyond_rad[K] == pytest.approx(np.radians(20.0))
    assert found.dof[K] == MODEL.joints["left_shank"].v.start + 1
    rest = np.arange(len(FITS.limbs)) != K
    assert (found.misfit_m[rest] < 1e-9).all() and (found.beyond_rad[rest] == 0.0).all()


def test_a_body_fits_within_the_largest_distance_and_excess():
    q = bent(-0.6)
    excess = FITS.evidence(q, SENSOR.positions(q)).beyond_rad.max()
    seen = SENSOR.positions(q)
    seen[4] += [0.02, 0.0, 0.0]
    seen[7] = np.nan
    assert 0.1 < excess < 0.7
    for most_m, most_rad in ((0.021, 1.01 * excess), (0.019, 1.01 * excess), (0.021, 0.99 * excess)):
        fits = most_m > 0.02 and most_rad > excess
        assert FITS.fits_within(q, seen, most_m, most_rad) == fits


def test_ranges_may_be_left_out():
    q = bent(-np.radians(30.0))
    free = FITS.fit(LEG, q, SENSOR.positions(q), ranged=False)
    held = FITS.fit(LEG, q, SENSOR.positions(q))
    assert free.beyond_rad == pytest.approx(np.radians(20.0), abs=0.002)
    assert held.beyond_rad < free.beyond_rad - 0.02


def test_what_no_marker_shows_belongs_to_no_limb():
    hidden = np.zeros(MODEL.nv, dtype=bool)
    hidden[MODEL.joints["left_toes"].v] = True
    found = next(
        one for one in LimbFits(SENSOR, np.full(36, 0.005), hidden).limbs if one.name == "left_thigh"
    )
    assert "left_toes" not in [one.segment for one in found.joints]
    assert MODEL.joints["left_toes"].v.start not in found.dofs


def test_the_trunk_is_fitted_by_its_own_markers():
    q = bent(0.5)
    step = np.zeros(MODEL.nv)
    step[:3] = 0.05
    moved, seen = MODEL.integrate(q, step), SENSOR.positions(q)
    seen[FITS.on_limb[K]] += 0.3
    found = FITS.trunk(moved, seen)
    assert np.abs(MODEL.difference(q, found)[:6]).max() < 0.005
