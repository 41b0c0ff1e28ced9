"""The centre of mass that puts the pressure where it is wanted, the split of the load, and the turning in flight."""

import numpy as np
import pytest

from mbkf.conventions import GRAVITY_M_S2
from mbkf.synthesis.balance import HorizontalPath
from mbkf.synthesis.contact import Load, split
from mbkf.synthesis.dual_numbers import Dual
from mbkf.synthesis.flight import Tumbling
from mbkf.synthesis.plan import Flight


def zero_moment_point(com, turning):
    """(T, 2) point of the floor about which the ground's force has no horizontal moment.

    ``turning`` is L̇_y / m and −L̇_x / m.
    """
    lift = GRAVITY_M_S2 + com.second[:, 2]
    return com.value[:, :2] - (com.value[:, 2:] * com.second[:, :2] + turning) / lift[:, None]


def test_pressure_follows_its_target():
    times = np.linspace(0, 3, 301)
    target = np.column_stack([0.05 * np.sin(2 * times), 0.03 * np.cos(times)])
    turning = np.column_stack([np.sin(3 * times), np.cos(2 * times)]) * 0.2
    height = Dual(0.9 + 0 * times, 0 * times, 0 * times)
    path = HorizontalPath([(0.0, 3.0)])
    path.solve(times, target, height, turning)
    plane = path(times)
    com = Dual(*(np.column_stack([p, h]) for p, h in zip(plane.orders, height.orders, strict=True)))
    assert np.abs(zero_moment_point(com, turning) - target).max() < 1e-4


def test_between_spells_the_path_is_straight_and_uniform():
    times = np.linspace(0, 2, 201)
    path = HorizontalPath([(0.0, 0.8), (1.1, 2.0)])
    path.solve(
        times,
        np.zeros((201, 2)) + 0.05 * times[:, None],
        Dual(0.9 + 0 * times, 0 * times, 0 * times),
        np.zeros((201, 2)),
    )
    for edge in (0.8, 1.1):
        before, after = path(np.array([edge - 1e-9])), path(np.array([edge + 1e-9]))
        for x, y in zip(before.orders, after.orders, strict=True):
            assert np.abs(x - y).max() < 1e-5
    air = path(np.linspace(0.81, 1.09, 5))
    assert np.abs(air.second).max() == 0
    assert np.ptp(air.first, axis=0).max() < 1e-12


def test_the_feet_together_give_the_ground_s_wrench():
    rng = np.random.default_rng(0)
    share = np.array([0.0, 0.3, 1.0, 0.7])
    load = Load(share, rng.normal(0, 0.1, (4, 2, 2)), np.array([True, True, True, False]))
    wrench = np.column_stack([rng.normal(0, 30, (4, 2)), rng.uniform(500, 900, 4), rng.normal(0, 20, (4, 3))])
    wrenches, centres = split(wrench, load, np.full(4, 0.9))
    assert np.abs(wrenches.sum(axis=1)[:3] - wrench[:3]).max() < 1e-10
    assert not wrenches[3].any()
    assert np.isnan(centres[[0, 2, 3, 3], [0, 1, 0, 1]]).all()


def test_a_spinning_box_keeps_its_momentum():
    """Momentum = inertia · rate, with an inertia that changes: the rate must change against it."""
    plan = Flight(
        1.0,
        1.4,
        *(
            tuple([(0.0, 0.0), (1.0, 0.1)] for _ in range(3)),
            tuple([(1.4, 0.3), (2.0, 0.0)] for _ in range(3)),
        ),
    )
    tumbling = Tumbling(plan)

    def momentum(angles):
        inertia = 1 + 0.5 * np.sin(5 * tumbling.times)
        return np.column_stack([inertia * angle.first for angle in angles])

    assert tumbling.refine(momentum, 20) < 1e-10
    x = tumbling.curves()[0]
    at = np.array([1.0, 1.4])
    assert x(at).value == pytest.approx([0.1, 0.3])
    inside = np.linspace(1.01, 1.39, 7)
    kept = (1 + 0.5 * np.sin(5 * inside)) * x(inside).first
    assert np.ptp(kept) < 1e-9
    step = np.abs(x(at + 1e-9).second - x(at - 1e-9).second)
    assert step.max() < 1e-5
