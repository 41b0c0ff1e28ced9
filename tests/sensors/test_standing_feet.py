"""Feet that stand: derivatives by the whole posture, which feet count, and soles as they lay on the floor."""

from types import SimpleNamespace

import numpy as np
import pinocchio as pin
import pytest

from mbkf.filters.dynamic.plant import DynamicState
from mbkf.sensors.block import Frame, Notes, OperatingPoint
from mbkf.sensors.contact.feet import FeetOnBody
from mbkf.sensors.contact.records import Contact
from mbkf.sensors.standing_feet import (
    FOOT_REST,
    RESTING_ROWS,
    ROLLING_ROWS,
    Rest,
    StandingDecision,
    StandingFeet,
    StandingSettings,
)
from tests.dynamics import singer
from tests.motions import moderate_pose, reference_model

MODEL = reference_model()
PLANT = singer(MODEL)
RNG = np.random.default_rng(5)
Q, V = moderate_pose(MODEL, RNG), RNG.normal(size=MODEL.nv)
N = PLANT.layout.size


def at(q, v):
    state = DynamicState(q, v, np.zeros(MODEL.nv), np.zeros(12), np.eye(N), np.zeros(6))
    return OperatingPoint(state, None)


def stacked(rows):
    whole = np.zeros((sum(len(one.innovation) for one in rows), N))
    first = 0
    for one in rows:
        last = first + len(one.innovation)
        whole[first:last, : one.jacobian.shape[1]] = one.jacobian
        first = last
    return whole, np.concatenate([one.innovation for one in rows])


@pytest.mark.parametrize(
    "decision",
    [
        StandingDecision((0,), (0.4,), (1,)),
        StandingDecision((0, 1), (0.0, 0.1)),
        StandingDecision((), (), (0,)),
    ],
)
def test_rows_are_the_derivatives_of_their_innovations(decision):
    block, h = StandingFeet(MODEL, 0.01), 1e-6
    rows, _ = stacked(block.linearise(at(Q, V), decision))
    start, numeric = at(Q, V).state, np.empty_like(rows)
    for k, one in enumerate(np.eye(N)):
        moved = [PLANT.retract(start, sign * h * one, start.P) for sign in (1.0, -1.0)]
        ahead, back = (stacked(block.linearise(OperatingPoint(s, None), decision))[1] for s in moved)
        numeric[:, k] = -(ahead - back) / (2 * h)
    # The point of the foot that is looked at is the same before and after a step.
    np.testing.assert_allclose(rows, numeric, atol=2e-6 * np.abs(numeric).max())


def test_a_body_at_rest_on_the_floor_it_stood_on_has_nothing_to_correct():
    q = Q.copy()
    lowest = np.array(FeetOnBody(MODEL).at(q, V).soles)[0, :2, 2].min()
    q[2] -= lowest
    block = StandingFeet(MODEL, 0.01, standing_q=q)
    _, innovation = stacked(block.linearise(at(q, np.zeros(MODEL.nv)), StandingDecision((0,), (0.0,))))
    np.testing.assert_allclose(innovation, 0.0, atol=1e-9)


def test_no_decision_has_more_rows_than_stated():
    block, place = StandingFeet(MODEL, 0.01), np.zeros(2)
    for decision, most in (
        (StandingDecision((0, 1), (0.4, 0.0), (), (place, place)), 2 * RESTING_ROWS),
        (StandingDecision((1,), (0.4,), (0,), (None, place)), RESTING_ROWS + ROLLING_ROWS),
        (StandingDecision((), (), (0, 1)), 2 * ROLLING_ROWS),
    ):
        assert len(stacked(block.linearise(at(Q, V), decision))[1]) == most


REST = np.zeros(MODEL.nv)


def decided(rest, contacts, v=REST):
    block, notes = StandingFeet(MODEL, 0.01), Notes()
    notes.contact = None if contacts is None else SimpleNamespace(contacts=contacts)
    readings = {} if rest is None else {FOOT_REST: np.array(rest, dtype=float)}
    return block.decide(at(Q, v), Frame(np.zeros((0, 3)), np.zeros((0, 6)), None, readings), Rest(), notes)


def test_a_foot_at_rest_stands_and_one_that_carries_weight_rolls():
    both = (Contact.UNMEASURED, Contact.UNMEASURED)
    assert decided((1, 0), both) == StandingDecision((0,), (0.0,), (1,))
    assert decided((np.nan, 1), (Contact.AIR, Contact.UNMEASURED)) == StandingDecision((1,), (0.0,), ())
    assert decided(None, (Contact.AIR, Contact.AIR)) == StandingDecision()
    assert decided((0, 1), None) == StandingDecision((1,), (0.0,), ())


def test_a_foot_in_swing_does_not_roll_however_low_it_is():
    both, swinging = (Contact.UNMEASURED, Contact.UNMEASURED), np.zeros(MODEL.nv)
    swinging[MODEL.joint("right_thigh").v] = 0.0, 4.0, 0.0
    assert decided((0, 0), both).rolling == (0, 1)
    assert decided((0, 0), both, swinging).rolling == (1,)


@pytest.mark.parametrize("turning", [0.0, 0.3])
def test_what_a_foot_at_rest_is_read_to_do_counts_less_the_more_it_turns(turning):
    s = StandingSettings()
    block = StandingFeet(MODEL, 0.01, s)
    still, heel, *_ = block.linearise(at(Q, V), StandingDecision((0,), (turning,)))
    known, *_ = StandingFeet(MODEL, 0.01, s).linearise(at(Q, V), StandingDecision((0,), (0.0,)))
    # A stance of half a second is fifty frames that err alike, by the lever times the turning.
    lever = s.standing_lever_m * turning * 50.0**0.5
    for rows, sd in ((slice(0, 3), s.standing_speed_m_s), (slice(3, 6), s.standing_turn_rad_s)):
        more = lever if rows.start == 0 else lever / s.standing_lever_m
        np.testing.assert_allclose(
            still.innovation[rows] * np.hypot(sd, more), known.innovation[rows] * sd, rtol=1e-12
        )
    size = np.hypot(s.standing_height_m, 0.25 * lever)
    np.testing.assert_allclose(
        np.abs(heel.jacobian[0, 2] ** 2 + heel.jacobian[0, 0] ** 2 + heel.jacobian[0, 1] ** 2),
        size**-2,
        rtol=1e-9,
    )


def test_a_foot_at_rest_for_longer_than_a_step_stays_where_it_is_until_it_moves():
    block, here = StandingFeet(MODEL, 0.25), at(Q, V)
    memory, kept = block.begin(), []
    for rest in (True, True, True, True, True, False, True):
        decision = StandingDecision((0,), (0.0,)) if rest else StandingDecision()
        memory = block.remember(here.state, here, decision, memory)
        kept.append(memory.places[0] is not None)
    assert kept == [False, False, False, True, True, False, False]
    assert memory.places[1] is None


def test_a_foot_at_rest_is_read_to_move_as_the_middle_of_heel_and_ball_does():
    """Against the place of that middle a moment later, in the foot's own axes."""
    block, h, s = StandingFeet(MODEL, 0.01), 1e-6, StandingSettings()
    still, *_ = block.linearise(at(Q, V), StandingDecision((0,), (0.0,)))
    feet, foot = FeetOnBody(MODEL), MODEL.joint(MODEL.roles.feet[0]).joint_id

    def middle(time_s):
        q = pin.integrate(MODEL.pin_model, Q, time_s * V)
        return np.mean(feet.at(q, V).soles[0][:2], axis=0)

    velocity = (middle(h) - middle(-h)) / (2.0 * h)
    rotation = MODEL.placements(Q)[0][foot]
    np.testing.assert_allclose(-s.standing_speed_m_s * still.innovation[:3], rotation.T @ velocity, atol=1e-7)
