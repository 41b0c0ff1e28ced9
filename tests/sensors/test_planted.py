"""A loaded foot stands still: velocity of its point and its turning against finite differences."""

from types import SimpleNamespace

import numpy as np
import pytest

from mbkf.model.layout import Layout
from mbkf.model.soles import sole_locals
from mbkf.sensors.block import Notes, OperatingPoint
from mbkf.sensors.contact.records import Planted
from mbkf.sensors.contact.rules import STANDING
from mbkf.sensors.marker_sensor import MarkerSensor
from mbkf.sensors.planted import PlantedDecision, PlantedFeet, PlantedSettings, lying_level, standing_still
from tests.motions import central_difference, moderate_pose, reference_model

MODEL = reference_model()
Q = moderate_pose(MODEL, np.random.default_rng(3))
V = np.random.default_rng(4).normal(size=MODEL.nv)
SOLES = MarkerSensor(MODEL, *sole_locals(MODEL))
SOLE = [Planted(name, SOLES.positions(Q)[3 * k], flat=False) for k, name in enumerate(MODEL.roles.feet)]


@pytest.mark.parametrize("foot", [0, 1])
def test_rows_are_the_velocity_of_the_point(foot):
    point, h = SOLES.positions(Q)[3 * foot], 1e-6
    moved = [SOLES.positions(MODEL.integrate(Q, s * h * V))[3 * foot] for s in (-1, 1)]
    velocity = (moved[1] - moved[0]) / (2 * h)
    rows, short = standing_still(MODEL, Q, V, Planted(MODEL.roles.feet[foot], point, flat=False), 0.5, 1.0)
    np.testing.assert_allclose(0.5 * rows @ V, velocity, atol=1e-7)
    np.testing.assert_allclose(short, -rows @ V, atol=1e-12)


@pytest.mark.parametrize("foot", [0, 1])
def test_a_flat_foot_does_not_turn_either(foot):
    """All six rows vanish on motions that leave the foot where it is, and on none that turns it."""
    point = SOLES.positions(Q)[3 * foot]
    rows, _ = standing_still(MODEL, Q, V, Planted(MODEL.roles.feet[foot], point, flat=True), 0.5, 1.0)
    assert rows.shape == (6, MODEL.nv) and np.linalg.matrix_rank(rows) == 6
    still = V - np.linalg.pinv(rows) @ (rows @ V)
    h = 1e-6
    moved = [SOLES.positions(MODEL.integrate(Q, s * h * still)).reshape(2, 3, 3)[foot] for s in (-1, 1)]
    np.testing.assert_allclose((moved[1] - moved[0]) / (2 * h), 0.0, atol=1e-6)


def test_on_a_belt_the_point_goes_with_it():
    """The rows vanish for a motion that moves the foot with the belt, and draw one that stands still along."""
    point, belt = SOLES.positions(Q)[0], (-1.2, 0.3)
    planted = Planted(MODEL.roles.feet[0], point, flat=True)
    rows, short = standing_still(MODEL, Q, V, planted, 0.05, 0.2, belt)
    moved = np.array([*belt, 0.0, 0.0, 0.0, 0.0]) / np.repeat([0.05, 0.2], 3)
    along = V + np.linalg.pinv(rows) @ (moved - rows @ V)
    np.testing.assert_allclose(standing_still(MODEL, Q, along, planted, 0.05, 0.2, belt)[1], 0.0, atol=1e-9)
    np.testing.assert_allclose(short, moved - rows @ V, atol=1e-12)


def test_a_belt_is_followed_less_closely_than_a_floor():
    block = PlantedFeet(MODEL, None, PlantedSettings(planted_speed_sd=0.03, belt_speed_share=0.1))
    block.bind(Layout.of(MODEL.nv, q=MODEL.nv, v=MODEL.nv), MODEL)
    at = OperatingPoint(SimpleNamespace(q=Q, v=V), None)
    foot = Planted(MODEL.roles.feet[0], SOLES.positions(Q)[0], flat=False)
    (floor,) = block.linearise(at, PlantedDecision((foot,), (), slides_m_s=(0.0,)))
    (belt,) = block.linearise(at, PlantedDecision((foot,), (), (-0.3, 0.4), (0.0,)))
    np.testing.assert_allclose(belt.jacobian, floor.jacobian * 0.03 / np.hypot(0.03, 0.05))
    away = np.hypot(0.03, 0.05) * (belt.innovation + belt.jacobian @ V)
    np.testing.assert_allclose(away, [-0.3, 0.4, 0.0], atol=1e-12)


@pytest.mark.parametrize("belt", [(0.0, 0.0), (-1.5, 0.2)])
@pytest.mark.parametrize("slide", [0.0, 0.5, 2.0])
def test_a_foot_that_is_faster_than_a_standing_one_is_held_by_its_excess(slide, belt):
    """Against the floor that is known: the limits of a standing foot's speed count, the excess adds to the spread."""
    block = PlantedFeet(MODEL, SimpleNamespace(planted=lambda contact, q, foot: SOLE[foot]))
    block.bind(Layout.of(MODEL.nv, q=MODEL.nv, v=MODEL.nv), MODEL)
    jacobian = MODEL.segment_jacobian(Q, SOLE[0].segment, SOLE[0].point_m)
    speed = STANDING.speed_m_s + slide if slide else 0.9 * STANDING.speed_m_s
    v = np.linalg.pinv(jacobian[:3]) @ [belt[0], belt[1] - speed, 0.0]
    at = OperatingPoint(SimpleNamespace(q=Q, v=v), None)
    hidden = np.array([MODEL.joint(MODEL.roles.feet[0]).v.start])
    notes = Notes(unmarked=hidden, contact=SimpleNamespace(floor_m_s=belt))
    decision = block.decide(at, None, None, notes)
    assert decision.still == (SOLE[0],)
    np.testing.assert_allclose(decision.slides_m_s, [slide], atol=1e-9)
    (rows,) = block.linearise(at, decision)
    own = block.settings.planted_speed_sd, block.settings.belt_speed_share * np.hypot(*belt)
    np.testing.assert_allclose(rows.jacobian, jacobian[:3] / np.hypot(np.hypot(*own), slide), atol=1e-9)


def test_smaller_spreads_weigh_more():
    planted = Planted(MODEL.roles.feet[0], SOLES.positions(Q)[0], flat=True)
    coarse, fine = (standing_still(MODEL, Q, V, planted, sd, sd)[0] for sd in (1.0, 0.1))
    np.testing.assert_allclose(fine, 10 * coarse)


@pytest.mark.parametrize("foot", MODEL.roles.feet)
def test_level_rows_are_the_inclination(foot):
    joint = MODEL.joint(foot).joint_id

    def inclination(q):
        return MODEL.placements(q)[0][joint][:2, 2]

    rows, short = lying_level(MODEL, Q, foot, 0.5)
    np.testing.assert_allclose(0.5 * rows, central_difference(MODEL, inclination, Q), atol=1e-7)
    np.testing.assert_allclose(0.5 * short, -inclination(Q))
    np.testing.assert_allclose(lying_level(MODEL, MODEL.neutral(), foot, 0.5)[1], 0.0, atol=1e-12)
