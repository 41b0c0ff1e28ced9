"""Ranks of systems whose answer is known, in any units."""

import numpy as np
import pytest

from mbkf.errors import ShapeError
from mbkf.filters.observability import (
    OBSERVED_SD,
    WINDOW_S,
    components,
    state_observability,
    whitened,
)
from mbkf.filters.readings import summed
from mbkf.model.layout import ROOT_RESIDUAL, ExtraState, Layout
from mbkf.numerics.kalman import information
from mbkf.sensors.block import Block, Rows
from tests.motions import reference_model

MODEL = reference_model()
MASS_KG = 3.0
PUSHED = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0 / MASS_KG], [0.0, 0.0, 0.0]])
"""F of position, velocity and force of a mass."""


def found(rows, F=PUSHED, sizes=(0.1, 1.0, 10.0)):
    sizes = np.array(sizes)
    return state_observability(np.atleast_2d(rows) * sizes, F, sizes)


def test_the_position_of_a_mass_shows_the_force_on_it():
    """x = x₀ + v τ + f τ²/2m: the three terms are the singular values where each shows in a reading of its own."""
    seen = found([1.0 / 0.005, 0.0, 0.0])
    assert (seen.reading_rank, seen.rank) == (1, 3)
    terms = np.array([0.1, 1.0 * WINDOW_S, 10.0 * WINDOW_S**2 / (2.0 * MASS_KG)]) / 0.005
    np.testing.assert_allclose(seen.singular_values, np.sort(terms)[::-1])
    assert np.isnan(seen.gap[1])
    np.testing.assert_allclose(seen.unobserved_share, 0.0)


def test_a_force_without_effect_is_not_observed():
    cut = PUSHED.copy()
    cut[1, 2] = 0.0
    blind = found([1.0 / 0.005, 0.0, 0.0], cut)
    assert blind.rank == 2
    np.testing.assert_allclose(blind.unobserved_share, [0.0, 0.0, 1.0], atol=1e-12)
    assert blind.gap[0] > 1.0
    assert blind.gap[1] < 1e-12


def test_a_velocity_does_not_show_where_the_mass_is():
    blind = found([0.0, 1.0 / 0.01, 0.0])
    assert (blind.reading_rank, blind.rank) == (1, 2)
    np.testing.assert_allclose(blind.unobserved_share, [1.0, 0.0, 0.0], atol=1e-12)


def test_two_forces_on_one_mass_are_known_by_their_sum_alone():
    F = np.zeros((4, 4))
    F[0, 1], F[1, 2:] = 1.0, 1.0 / MASS_KG
    shared = found([1.0 / 0.005, 0.0, 0.0, 0.0], F, (0.1, 1.0, 10.0, 10.0))
    assert shared.rank == 3
    np.testing.assert_allclose(shared.unobserved_share, [0.0, 0.0, 0.5, 0.5], atol=1e-12)


def test_the_rank_does_not_depend_on_units():
    """Positions in mm, forces in kN: same system, same answer."""
    units = np.array([1e3, 1e3, 1e-3])
    F = units[:, None] * PUSHED / units
    other = found(np.array([1.0 / 0.005, 0.0, 0.0]) / units, F, units * [0.1, 1.0, 10.0])
    np.testing.assert_allclose(other.singular_values, found([1.0 / 0.005, 0.0, 0.0]).singular_values)


def test_a_direction_counts_from_the_bound_on():
    still = np.zeros((1, 1))
    assert found([OBSERVED_SD * 1.01], still, (1.0,)).rank == 1
    assert found([OBSERVED_SD * 0.99], still, (1.0,)).rank == 0


class Law(Block):
    """A prior or an instrument; only its kind matters here."""

    def __init__(self, prior):
        self.prior = prior

    def linearise(self, at, decision):
        raise NotImplementedError


def test_readings_are_whitened_with_and_without_priors():
    rng, layout = np.random.default_rng(3), Layout.of(2, q=2, v=2)
    seen, law, prior = rng.normal(size=(3, 2)), rng.normal(size=(2, 4)), rng.normal(size=(1, 2))
    said = [
        information(np.zeros(3), seen, np.full(3, 0.5)),
        Rows(law, np.zeros(2), readings=1),
        information(np.zeros(1), prior, np.ones(1)),
    ]
    readings = summed([Law(False), Law(False), Law(True)], said, layout)
    sizes = np.array([0.1, 0.2, 3.0, 4.0])
    of_instruments = np.zeros((4, 4))
    of_instruments[:2, :2] = seen.T @ seen / 0.25
    all_rows = of_instruments + law.T @ law
    all_rows[:2, :2] += prior.T @ prior
    of_instruments += np.outer(law[0], law[0])
    for rows, matrix in (
        (whitened(readings, sizes), of_instruments),
        (whitened(readings, sizes, priors=True), all_rows),
    ):
        np.testing.assert_allclose(rows.T @ rows, matrix * np.outer(sizes, sizes), atol=1e-12)


def test_components_have_names_for_every_state():
    nu = MODEL.nv - 2 + 12
    torque = components(Layout.forced(MODEL.nv, nu, wrenches=True), MODEL)
    assert len(torque) == 166
    assert [one.part for one in torque[104:110]] == ["pelvis residual"] * 6
    assert {one.name for one in torque if one.part == "torque"}.isdisjoint({"right_toes_y", "left_toes_y"})
    assert (torque[-12].part, torque[-12].name) == ("right foot", "force x")
    assert (torque[-1].part, torque[-1].name) == ("left foot", "moment z")
    own = [
        ExtraState(ROOT_RESIDUAL, np.zeros(6), np.full(6, 7.0), np.ones(6)),
        ExtraState("bias", *[np.ones(1)] * 3),
    ]
    dynamic = components(Layout.dynamic(MODEL.nv, own), MODEL)
    assert len(dynamic) == 3 * MODEL.nv + 12 + 7
    assert dynamic[-2] == (ROOT_RESIDUAL, "moment z", 7.0)
    assert dynamic[-1] == ("bias", "1", 1.0)
    assert dynamic[2 * MODEL.nv].part == "acceleration"


def test_wrong_shapes_are_refused():
    with pytest.raises(ShapeError, match="F must"):
        state_observability(np.zeros((1, 3)), np.eye(2), np.ones(3))
    with pytest.raises(ShapeError, match="sizes"):
        state_observability(np.zeros((1, 3)), np.eye(3), np.ones(2))
