"""Limbs reach their far ends, their segments' moments add up, and the derivatives are the numeric ones."""

import numpy as np
import pytest

from mbkf.synthesis import dual_numbers
from mbkf.synthesis.curves import sinusoid
from mbkf.synthesis.dual_numbers import Dual
from mbkf.synthesis.two_links import STRAIGHT_RAD, Limb, TwoLinks

TIMES = np.linspace(0.0, 2.0, 9)
STRAIGHT = np.array([0.0, 0.0, -0.42]), np.array([0.0, 0.0, -0.40])
BESIDE = np.array([0.02, -0.01, -0.42]), np.array([-0.015, 0.012, -0.40])
"""Ends of links on their z axes, and as joints of a person lie beside them."""

ENDS = pytest.mark.parametrize("ends", [STRAIGHT, BESIDE])
UPPER, LOWER = np.array([0.02, 0.01, -0.3]), np.array([0.01, -0.02, -0.2])


def moving(*means):
    return dual_numbers.stack(
        [sinusoid(0.05, 0.4 + 0.1 * k, 0.3 * k, mean)(TIMES) for k, mean in enumerate(means)]
    )


def links(bends, ends=BESIDE):
    return TwoLinks(ends, sinusoid(0.03, 0.5, 0.1)(TIMES), sinusoid(0.05, 0.3, 0.4)(TIMES), bends)


def bend(span, bends=1.0, across=(0.2, 1.0, 0.1), ends=BESIDE):
    return links(bends, ends).bend(span, moving(*across))


@ENDS
@pytest.mark.parametrize("bends", [1.0, -1.0])
def test_the_far_end_is_reached_and_the_middle_joint_bends_its_way(bends, ends):
    span = moving(0.1, 0.05, -0.7)
    found = bend(span, bends, ends=ends)
    upper, lower = found.rotations()
    reached = upper.apply(ends[0]) + lower.apply(ends[1])
    for x, y in zip(reached.orders, span.orders, strict=True):
        assert np.abs(x - y).max() < 1e-12 * (1 + np.abs(y).max())
    relative = np.einsum("tji,tjk->tik", upper.value, lower.value)
    assert (bends * relative[:, 0, 2] > 0).all()
    turned = dual_numbers.rotation(1, Dual.constant(bends * found.flexion)).value @ found.links.small.value
    np.testing.assert_allclose(relative, turned, atol=1e-12)
    assert found.used == pytest.approx(np.linalg.norm(span.value, axis=1) / sum(map(np.linalg.norm, ends)))


@ENDS
def test_out_of_reach_the_limb_stays_short_and_almost_straight(ends):
    span = moving(0.0, 0.0, -1.2)
    found = bend(span, ends=ends)
    assert not found.flexion_by_distance.any()
    upper, lower = found.rotations()
    reached = upper.apply(ends[0]).value + lower.apply(ends[1]).value
    assert np.abs(np.cross(reached, span.value)).max() < 1e-12
    short = np.linalg.norm(reached, axis=1) / sum(map(np.linalg.norm, ends))
    assert ((short > 0.997) & (short < 1.0)).all()
    if ends is STRAIGHT:
        assert found.flexion == pytest.approx(STRAIGHT_RAD)


def test_what_the_links_carry_is_turned_with_them():
    found = bend(moving(0.1, 0.05, -0.7))
    carried, _ = found.carried(UPPER, found.links.small.apply(LOWER))
    upper, lower = found.rotations()
    expected = upper.apply(UPPER) + lower.apply(LOWER)
    for x, y in zip(carried.orders, expected.orders, strict=True):
        assert np.abs(x - y).max() < 1e-12 * (1 + np.abs(y).max())


@pytest.mark.parametrize("bends", [1.0, -1.0])
@pytest.mark.parametrize("down", [-0.75, -0.5, -1.2])
def test_derivatives_by_the_ends_and_the_axis_are_the_numeric_ones(bends, down):
    span, axis, h = moving(0.1, 0.05, down), moving(0.2, 1.0, 0.1), 1e-6
    made = links(bends)

    def at(span_step, axis_step):
        found = made.bend(span + span_step, axis + axis_step)
        return found.carried(UPPER, made.small.apply(LOWER))

    still = np.zeros(3)
    by_span, by_across = at(still, still)[1]
    for k, step in enumerate(h * np.eye(3)):
        numeric = (at(step, still)[0].value - at(-step, still)[0].value) / (2 * h)
        assert np.abs(numeric - by_span[:, :, k]).max() < 1e-7
        numeric = (at(still, step)[0].value - at(still, -step)[0].value) / (2 * h)
        assert np.abs(numeric - by_across[:, :, k]).max() < 1e-7


def limb(held, turns):
    """An arm that reaches a place, as far as it is held; its elbow's axis, where it turns, goes with the shoulder."""
    goal, hanging, point = moving(0.3, 0.1, 0.2), moving(0.0, 0.0, -0.6), np.array([0.1, 0.9, -0.4])
    own = links(-1.0)
    return Limb(
        own,
        moving(0.0, -0.2, 0.5),
        lambda near: hanging + (goal - near - hanging) * held,
        lambda near: dual_numbers.cross(point - near, goal - near) if turns else moving(0.0, 1.0, 0.0),
        5.0,
        UPPER,
        own.small.apply(LOWER),
        0.5,
        np.full(len(TIMES), held),
        point - goal.value if turns else None,
    )


@pytest.mark.parametrize("turns", [False, True])
@pytest.mark.parametrize("held", [1.0, 0.4, 0.0])
def test_the_moment_by_the_pelvis_is_the_numeric_derivative(held, turns):
    pelvis, h = moving(0.1, 0.1, 0.2), 1e-6
    reaching = limb(held, turns)
    moment, stated = reaching.moment_by_pelvis(pelvis)
    assert moment.value.shape == (len(TIMES), 3)
    for k, step in enumerate(h * np.eye(3)):
        ahead, behind = (reaching.moment_by_pelvis(pelvis + way)[0].value for way in (step, -step))
        assert np.abs((ahead - behind) / (2 * h) - stated[:, :, k]).max() < 1e-7


def test_a_straight_constant_limb_does_not_move():
    still = Dual.constant(np.tile([0.0, 0.0, -0.7], (len(TIMES), 1)))
    zero = Dual.constant(np.zeros(len(TIMES)))
    across = Dual.constant(np.tile([0.0, 1.0, 0.0], (len(TIMES), 1)))
    for rotation in TwoLinks(STRAIGHT, zero, zero).bend(still, across).rotations():
        assert not rotation.first.any()
        assert not rotation.second.any()
