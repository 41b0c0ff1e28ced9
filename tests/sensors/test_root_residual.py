"""The root residual: its process without readings, its place in Newton's law, and a share of 0."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.conventions import GRAVITY_M_S2
from mbkf.model.layout import ROOT_RESIDUAL, SUPPORT, UNSEEN_MOMENT, ExtraState
from mbkf.model.newton_euler import NewtonEuler
from mbkf.sensors.block import Notes
from mbkf.sensors.contact.records import Contact, ContactDecision
from mbkf.sensors.newton_euler import NewtonEulerLaw, NewtonEulerSettings
from mbkf.sensors.root_residual import RootResidual, RootResidualSettings
from tests.dynamics import DT, dynamic_filter, prepared_at, random_state, singer, standing
from tests.motions import assert_near, reference_model

MODEL = reference_model()
WEIGHT_N = GRAVITY_M_S2 * MODEL.mass_kg
SETTINGS = RootResidualSettings(residual_share=0.06, residual_lever_m=0.02, residual_memory_s=0.5)
SD = WEIGHT_N * np.repeat([0.06, 0.02], 3)
LOAD = np.array([30.0, -20.0, 50.0, 4.0, -7.0, 9.0])


def bound(dt_s=DT, before=()):
    """The block in a state that holds other added states before its own, with its one state."""
    block = RootResidual(WEIGHT_N, dt_s, SETTINGS)
    (state,) = block.states()
    plant = singer(MODEL, [*before, state])
    block.bind(plant.layout, plant.model)
    return block, state, plant


def decay(block, residual=None, contact=None):
    """Rows about a residual (6,), while the feet stand so."""
    extra = np.zeros(block.layout.size - 3 * MODEL.nv - 12)
    extra[block.layout.extra_index(ROOT_RESIDUAL)] = 0.0 if residual is None else residual
    at = prepared_at(block, replace(random_state(MODEL, np.random.default_rng(0)), extra=extra))
    return block.linearise(at, Notes(contact=contact))


@pytest.mark.parametrize("dt_s", [0.005, 0.01, 0.02])
def test_the_filter_s_variance_stands_at_the_stated_one(dt_s):
    """From frame to frame it walks and reads zero; posterior and prior variance lie on both sides of σ²."""
    block, state, _ = bound(dt_s)
    assert_near(state.start_sd, SD, 1e-9)
    information = np.diag(decay(block).jacobian) ** 2
    posterior = np.ones(6)
    for _ in range(2000):
        prior = posterior + state.walk_sd**2 * dt_s
        posterior = 1.0 / (1.0 / prior + information)
    assert_near(np.sqrt(prior * posterior) / SD**2, np.ones(6), 1e-3)


def test_the_process_of_a_whole_trial_is_gauss_markov():
    """Its density is that of all steps and all readings of zero: covariance σ²/2 · e^(−2|t|/τ)."""
    frames, (block, state, _) = 400, bound()
    walk, read = 1.0 / (state.walk_sd[0] ** 2 * DT), decay(block).jacobian[0, 0] ** 2
    steps = np.diff(np.eye(frames), axis=0)
    covariance = np.linalg.inv(walk * steps.T @ steps + read * np.eye(frames))[frames // 2, frames // 2 :]
    lag_s = DT * np.arange(50)
    expected = 0.5 * SD[0] ** 2 * np.exp(-2.0 * lag_s / SETTINGS.residual_memory_s)
    np.testing.assert_allclose(covariance[:50], expected, rtol=0.01)


def test_rows_stand_at_the_residual_s_own_place():
    block, _, plant = bound(before=[ExtraState("mine", np.zeros(2), np.ones(2), np.zeros(2))])
    rows = decay(block, LOAD)
    assert rows.first == plant.layout[ROOT_RESIDUAL].start == 3 * MODEL.nv + 14
    assert_near(rows.innovation, -rows.jacobian @ LOAD, 1e-12)
    assert rows.readings == 0 and block.prior


@pytest.mark.parametrize(
    ("contacts", "scale"),
    [
        ((Contact.UNMEASURED, Contact.UNMEASURED), 3.0),
        ((Contact.AIR, Contact.UNMEASURED), 3.0),
        ((Contact.AIR, Contact.AIR), 1.0),
        ((Contact.MEASURED, Contact.UNMEASURED), 1.0),
        ((Contact.MEASURED, Contact.AIR), 1.0),
        ((Contact.SHARED, Contact.SHARED), 1.0),
    ],
)
def test_the_force_is_read_as_zero_more_sharply_while_feet_stand_and_no_plate_reads(contacts, scale):
    block, _, _ = bound()
    usual = decay(block, LOAD)
    contact = ContactDecision(contacts, np.zeros((2, 6)), np.zeros((2, 3)), False, None)
    rows = decay(block, LOAD, contact)
    each = np.repeat([scale, 1.0], 3)
    assert_near(rows.jacobian, each[:, None] * usual.jacobian, 1e-12)
    assert_near(rows.innovation, -rows.jacobian @ LOAD, 1e-12)
    assert rows.first == usual.first


@pytest.mark.parametrize("others", [(), (UNSEEN_MOMENT,), (SUPPORT,), (SUPPORT, UNSEEN_MOMENT)])
def test_newton_s_law_counts_it_beside_other_loads(others):
    """0 = [ID − Σ Jᵀ w] + r: innovation against a load that is added by hand, rows against finite differences."""
    sizes = {UNSEEN_MOMENT: 3, SUPPORT: 6}
    before = [
        ExtraState(name, np.zeros(sizes[name]), np.ones(sizes[name]), np.zeros(sizes[name]))
        for name in others
    ]
    _, _, plant = bound(before=before)
    law = NewtonEulerLaw(NewtonEuler(MODEL), NewtonEulerSettings(2.0, 0.5))
    law.bind(plant.layout, plant.model)
    rng = np.random.default_rng(1)
    extra = rng.normal(size=sum(sizes[name] for name in others) + 6)
    state = replace(random_state(MODEL, rng, standing(MODEL)), extra=extra)
    given = extra.copy()
    given[plant.layout.extra_index(ROOT_RESIDUAL)] += LOAD
    rows, moved = (law.prepare(replace(state, extra=one), None) for one in (extra, given))
    sd = np.repeat([2.0, 0.5], 3)
    assert_near(moved.innovation, rows.innovation - LOAD / sd, 1e-9)

    def innovation(x):
        return law.prepare(plant.retract(state, x, state.P), None).innovation

    # The law is linear in accelerations and loads, and steps along these can be larger.
    size = plant.layout.size
    steps = np.where(np.arange(size) < plant.layout.a.start, 1e-6, 1e-2)
    numeric = [
        (innovation(h * e) - innovation(-h * e)) / (2 * h) for h, e in zip(steps, np.eye(size), strict=True)
    ]
    jacobian = np.zeros((6, size))
    jacobian[:, : rows.jacobian.shape[1]] = rows.jacobian
    assert_near(jacobian, -np.array(numeric).T, 1e-6 * np.abs(jacobian).max())


def test_a_share_of_0_leaves_it_out_of_the_state():
    kalman = dynamic_filter(MODEL, residual_share=0.0)
    assert ROOT_RESIDUAL not in kalman.layout and kalman.layout.size == 3 * MODEL.nv + 12
    assert dynamic_filter(MODEL).layout.extra_index(ROOT_RESIDUAL) == slice(0, 6)
