"""Weak priors on posture and velocity: what they say, and of which dofs."""

import numpy as np

from mbkf.filters.kinematic.plant import KinematicState
from mbkf.model.layout import Layout
from mbkf.sensors.posture_sensor import PostureSensor
from mbkf.sensors.rest import PostureAndRest
from tests.dynamics import prepared_at
from tests.motions import assert_near, moderate_pose, random_model

SCALE, REST_SD = 10.0, 20.0


def said(unobservable=()):
    rng = np.random.default_rng(2)
    model = random_model(rng)
    nv = model.nv
    mask = np.zeros(nv, dtype=bool)
    mask[list(unobservable)] = True
    block = PostureAndRest(PostureSensor(model), mask, SCALE, REST_SD)
    block.bind(Layout.of(nv, q=nv, v=nv, u=3), model)
    state = KinematicState(moderate_pose(model, rng), rng.normal(size=nv), np.eye(2 * nv))
    return model, state, block.linearise(prepared_at(block, state), None)


def test_velocities_are_drawn_to_zero():
    model, state, found = said()
    v = slice(model.nv, 2 * model.nv)
    assert_near(found.matrix[v, v], np.eye(model.nv) / REST_SD**2, 1e-15)
    assert_near(found.vector[v], -state.v / REST_SD**2, 1e-15)
    assert not found.matrix[: model.nv, v].any()
    assert (found.readings, found.innovation) == (0, 0.0)


def test_a_posture_is_drawn_to_neutral_by_its_spread():
    model, state, found = said()
    sensor, q = PostureSensor(model), slice(model.nv)
    away = sensor.reading(state.q)
    J, weight = away.jacobian, (SCALE * sensor.sd) ** -2.0
    assert_near(found.matrix[q, q], J.T @ (J * weight[:, None]), 1e-12)
    assert_near(found.vector[q], -J.T @ (weight * away.deviation), 1e-12)


def test_of_dofs_that_no_marker_moves_with_nothing_is_said():
    model, _, found = said(unobservable=(30, 31, 32))
    assert not found.matrix[model.nv + 30 : model.nv + 33].any()
    assert not found.vector[model.nv + 30 : model.nv + 33].any()
    assert found.vector[model.nv + 29] != 0.0
