"""Plates under the feet: one per spot, at its height, around the pressure's path, and never one over another."""

from itertools import combinations

import numpy as np
import pytest

from mbkf.synthesis.plates import GAP_M, SIZE_M, Placement, outlines, placements, readings

HEIGHT_M = 0.18


def pushed(at, height, vertical=700.0):
    """Wrench about the world's origin of a slanted force at a point of a surface."""
    force = np.array([40.0, -25.0, vertical])
    return np.r_[force, np.cross([*at, height], force)]


@pytest.fixture
def stepping():
    """Wrenches and surfaces: the right foot on the floor, then on a step, the left foot beside it all the time."""
    wrench, surface = np.zeros((300, 2, 6)), np.zeros((300, 2))
    for k in range(300):
        wrench[k, 1] = pushed((0.05, 0.1 + 1e-4 * k), 0.0)
        if k < 100:
            wrench[k, 0] = pushed((0.05 + 1e-4 * k, -0.1), 0.0)
        elif k >= 150:
            wrench[k, 0] = pushed((0.10, -0.1), HEIGHT_M)
            surface[k, 0] = HEIGHT_M
    return wrench, surface


def placed(side, x, y, half=0.03, surface=0.0):
    middle = np.array([x, y])
    return Placement(side, ((0, 10),), middle, middle - half, middle + half, surface)


def overlap(a, b):
    low = np.maximum(a.min(axis=0)[:2], b.min(axis=0)[:2])
    high = np.minimum(a.max(axis=0)[:2], b.max(axis=0)[:2])
    return (high > low).all()


def holds(corners, placement):
    return (corners.min(axis=0)[:2] <= placement.low).all() and (
        corners.max(axis=0)[:2] >= placement.high
    ).all()


def test_a_spot_on_a_step_is_another_one_however_near(stepping):
    found = placements(*stepping)
    assert [(p.side, p.surface_m) for p in found] == [(0, 0.0), (1, 0.0), (0, HEIGHT_M)]
    assert found[2].middle == pytest.approx([0.10, -0.1])
    assert found[0].low == pytest.approx([0.05, -0.1])
    assert found[0].high == pytest.approx([0.0599, -0.1])


def test_spells_on_one_spot_share_a_plate():
    wrench = np.zeros((90, 2, 6))
    for k in (*range(30), *range(60, 90)):
        wrench[k, 0] = pushed((0.1 + 0.001 * k, 0.0), 0.0)
    (found,) = placements(wrench, np.zeros((90, 2)))
    assert found.spells == ((0, 30), (60, 90))
    assert [found.low[0], found.high[0]] == pytest.approx([0.1, 0.189])


def test_plates_lie_at_their_surface_and_so_does_the_pressure(stepping):
    wrench, surface = stepping
    plates = readings(wrench, surface, 1000.0, 0.0, 0.0, (0.0, 0.0), np.random.default_rng(0))
    assert [p.origin_m[2] for p in plates] == [0.0, 0.0, HEIGHT_M]
    assert np.ptp([p.corners_m[:, 2] for p in plates], axis=1).max() == 0
    assert plates[2].centre_of_pressure_m[200] == pytest.approx([0.10, -0.1, HEIGHT_M])
    total = sum(np.hstack([p.force_n, p.moment_nm + np.cross(p.origin_m, p.force_n)]) for p in plates)
    assert np.abs(total - wrench.sum(axis=1)).max() < 1e-9


def test_plates_far_apart_keep_the_usual_size():
    for corners in outlines([placed(0, 0.0, 0.0), placed(1, 2.0, 1.0), placed(0, 0.0, 3.0)]):
        assert np.ptp(corners, axis=0)[:2] == pytest.approx(SIZE_M)


def test_plates_in_any_arrangement_hold_their_pressure_and_do_not_overlap():
    """Spots in every direction at once, at least a gap and their pressures' paths apart."""
    rng, near = np.random.default_rng(4), 2 * 0.03 + 2 * GAP_M
    for _ in range(100):
        spots = []
        while len(spots) < 6:
            new = rng.uniform(-0.4, 0.4, 2)
            if all(np.abs(new - old).max() > near for old in spots):
                spots.append(new)
        row = [placed(k % 2, *spot, surface=0.1 * (k > 3)) for k, spot in enumerate(spots)]
        found = outlines(row)
        assert not any(overlap(a, b) for a, b in combinations(found, 2))
        assert all(holds(corners, p) for corners, p in zip(found, row, strict=True))
        assert [c[0, 2] for c in found] == [p.surface_m for p in row]
