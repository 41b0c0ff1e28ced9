"""The innovation gate: outliers go, good markers stay, and a lost state trusts the markers."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.stats import chi2

from mbkf.sensors.gating import TRACK_LOSS_M, ObservedDofs, gated
from mbkf.sensors.markers import MarkerSettings
from tests.motions import protocol_sensor, reference_model

MARKERS, NV = 10, 8
SETTINGS = MarkerSettings(gate=30.0, gate_radius_m=0.0)


class Reading:
    """Predicted markers that remember for which of them the Jacobian was asked."""

    def __init__(self, H):
        self.H, self.asked = H, np.zeros(len(H), dtype=bool)
        self.moves = np.eye(len(H))

    def only(self, markers):
        self.asked |= markers
        return SimpleNamespace(jacobian=self.H[markers])


def believable(y, H, P, noise, settings):
    """(M,) markers used, each being all that is seen of its segment."""
    return sorted_out(y, Reading(H), P, noise, settings).trusted


def sorted_out(y, reading, P, noise, settings):
    return gated(y, reading, P, noise, settings.gate, settings.gate_radius_m)


@pytest.fixture
def rng():
    return np.random.default_rng(1)


@pytest.fixture
def problem(rng):
    """Jacobian, covariance, noise, and innovations drawn from S = H P Hᵀ + R."""
    H = rng.normal(size=(MARKERS, 3, NV))
    A = 0.01 * rng.normal(size=(NV, NV))
    P, noise = A @ A.T, rng.uniform(0.002, 0.01, MARKERS)
    y = H @ np.linalg.cholesky(P) @ rng.normal(size=NV) + noise[:, None] * rng.normal(size=(MARKERS, 3))
    return y, H, P, noise


def mahalanobis(y, H, P, noise):
    triples = zip(y, H, noise, strict=True)
    return np.array([e @ np.linalg.solve(h @ P @ h.T + s**2 * np.eye(3), e) for e, h, s in triples])


def test_good_markers_are_kept(problem):
    assert believable(*problem, SETTINGS).all()


def test_an_outlier_is_refused_and_the_others_kept(problem):
    y, H, P, noise = problem
    y = y.copy()
    y[4] += 0.5
    np.testing.assert_array_equal(believable(y, H, P, noise, SETTINGS), np.arange(MARKERS) != 4)


@pytest.mark.parametrize("gate", [2.0, 5.0, 10.0])
def test_the_gate_is_the_mahalanobis_distance(rng, gate):
    H, A = rng.normal(size=(40, 3, NV)), rng.normal(size=(NV, NV))
    P, noise = A @ A.T, rng.uniform(0.5, 2, 40)
    y = 6.0 * rng.normal(size=(40, 3))
    inside = mahalanobis(y, H, P, noise) <= gate
    assert 5 < inside.sum() < 35
    expected = inside if inside.sum() >= 20 else np.ones(40, bool)
    np.testing.assert_array_equal(believable(y, H, P, noise, replace(SETTINGS, gate=gate)), expected)


def test_as_many_are_refused_as_chi_square_says(rng):
    """Independent innovations of the stated size fall outside the 90 % gate one time in ten."""
    count = 1000
    y = 0.01 * rng.normal(size=(count, 3))
    kept = believable(
        y,
        np.zeros((count, 3, NV)),
        np.eye(NV),
        np.full(count, 0.01),
        replace(SETTINGS, gate=chi2.ppf(0.9, 3)),
    )
    assert kept.mean() == pytest.approx(0.9, abs=0.03)  # ± 3 standard errors


def test_what_is_near_enough_is_kept_whatever_the_state_claims():
    """A state that is too sure of itself must not refuse markers a centimetre off."""
    y = np.zeros((MARKERS, 3))
    y[2, 0], y[3, 0] = 0.029, 0.031
    kept = believable(
        y,
        np.zeros((MARKERS, 3, NV)),
        np.eye(NV),
        np.full(MARKERS, 1e-4),
        replace(SETTINGS, gate_radius_m=0.03),
    )
    np.testing.assert_array_equal(kept, np.arange(MARKERS) != 3)


def test_when_most_markers_lie_outside_all_are_believed(problem):
    y, H, P, noise = problem
    y = y.copy()
    y[:6] += 1.0
    y[9] = np.nan
    np.testing.assert_array_equal(believable(y, H, P, noise, SETTINGS), np.arange(MARKERS) != 9)


def test_missing_markers_are_never_believed(problem):
    y, H, P, noise = problem
    y = y.copy()
    y[[0, 7]] = np.nan
    np.testing.assert_array_equal(np.flatnonzero(~believable(y, H, P, noise, SETTINGS)), [0, 7])
    assert not believable(np.full((MARKERS, 3), np.nan), H, P, noise, SETTINGS).any()


def test_the_jacobian_is_asked_for_only_of_far_markers(problem):
    y, H, P, noise = problem
    y = y.copy()
    y[3] = np.nan
    reach = float(np.sqrt(np.nanmax((y**2).sum(axis=1))))
    for radius in (reach + 1e-9, 0.9 * reach, 0.0):
        settings, reading = replace(SETTINGS, gate_radius_m=radius), Reading(H)
        seen, trusted, *_ = sorted_out(y, reading, P, noise, settings)
        np.testing.assert_array_equal(seen, np.arange(MARKERS) != 3)
        kept = (y**2).sum(axis=1) <= radius**2
        kept |= mahalanobis(y, H, P, noise) <= settings.gate
        np.testing.assert_array_equal(trusted, kept)
        np.testing.assert_array_equal(reading.asked, (y**2).sum(axis=1) > radius**2)


def test_a_segment_all_of_whose_markers_are_off_has_moved():
    """Two markers of one segment far off together are displaced and believed; one of two is refused."""
    rng = np.random.default_rng(8)
    y = 0.001 * rng.normal(size=(6, 3))
    reading = Reading(rng.normal(size=(6, 3, 4)))
    reading.moves = np.array([[1.0, 0.0], [1.0, 0.0], [1.0, 1.0], [1.0, 1.0], [0.0, 1.0], [0.0, 1.0]])
    P, noise = 1e-8 * np.eye(4), np.full(6, 0.005)
    y[2:4, 0] = 0.5
    together = sorted_out(y, reading, P, noise, SETTINGS)
    np.testing.assert_array_equal(np.flatnonzero(together.displaced), [2, 3])
    assert together.trusted.all()
    y[3] = 0.0
    alone = sorted_out(y, reading, P, noise, SETTINGS)
    np.testing.assert_array_equal(np.flatnonzero(~alone.trusted), [2])
    assert alone.displaced is None


@pytest.mark.parametrize("jump_m", [0.05, 0.2, 5.0])
def test_markers_that_are_mostly_far_off_have_left_the_state_behind(problem, jump_m):
    y, H, P, noise = problem
    near = replace(SETTINGS, gate_radius_m=0.03)
    y = 0.1 * y
    assert not sorted_out(y, Reading(H), P, noise, near).lost
    for movers in (MARKERS // 2, MARKERS // 2 + 1, MARKERS):
        moved = y.copy()
        moved[:movers, 0] += jump_m
        expected = jump_m > TRACK_LOSS_M and 2 * movers > MARKERS
        assert sorted_out(moved, Reading(H), P, noise, near).lost == expected


def test_a_segment_none_of_whose_markers_is_used_is_unmarked():
    """Its own joint's dofs alone, and no dof that no marker of the capture moves with."""
    model = reference_model()
    sensor = protocol_sensor(model)[0]
    hand = np.arange(model.nv)[model.joint("right_hand").v]
    unobservable = np.arange(model.nv) == hand[0]
    observed, trusted = ObservedDofs(sensor, unobservable), np.ones(len(sensor.segments), dtype=bool)
    assert len(observed.unmarked(trusted)) == 0
    trusted[np.isin(sensor.segments, ["right_hand"])] = False
    np.testing.assert_array_equal(observed.unmarked(trusted), hand[1:])
    np.testing.assert_array_equal(observed.carriers(~trusted), hand[1:])
    np.testing.assert_array_equal(observed.carried_by(hand[1:]), ~trusted)
    assert len(observed.unmarked(np.ones_like(trusted))) == 0


def test_a_prediction_that_knows_nothing_refuses_no_marker(problem):
    """Of a lost track the covariance may be so large that noise is lost in rounding, and S is singular."""
    y, H, _, noise = problem
    one = np.zeros(NV)
    one[0] = 1e20
    assert believable(y + 1.0, H, np.outer(one, one), noise, SETTINGS).all()
