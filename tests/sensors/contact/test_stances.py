"""Feet that stand together: plates under them sum to what they share, and free feet stand on the lowest point."""

import numpy as np

from mbkf.sensors.contact.rules import BOTH
from mbkf.sensors.contact.sharing import PUSH_SHARE, expected_stance
from mbkf.sensors.contact.stances import free_stance, shared_between
from tests.motions import assert_near

FLAT = [[[0.0, y, 0.01], [0.15, y, 0.01], [0.22, y, 0.01]] for y in (-0.1, 0.1)]
PELVIS = [0.1, 0.0, 0.95]


def test_feet_share_all_that_plates_under_either_of_them_read():
    """A third plate, which belongs to none, does not count."""
    rng = np.random.default_rng(0)
    wrench = rng.normal(0.0, 10.0, (3, 6))
    wrench[:, 2] = 400.0, 300.0, 200.0
    shared = shared_between(FLAT, PELVIS, wrench, (BOTH, -1, 1), (0.0, 0.5, 0.5))
    assert_near(shared.wrench.sum(axis=0), wrench[0] + wrench[2], 1e-9)
    assert_near(shared.centres_m[:, 2], np.zeros(2), 1e-12)


def test_free_feet_stand_on_their_lowest_point():
    raised = [FLAT[0], [[x, y, z - 0.02 * (x > 0.2)] for x, y, z in FLAT[1]]]
    free = free_stance(raised, PELVIS, (0.01, 0.01), (1.0, 1.0))
    expected = expected_stance(raised, 0.01 - 0.02)
    assert_near(free.stance.centres_m, expected.centres_m, 1e-12)
    assert_near(free.pelvis_m, np.array(PELVIS), 1e-12)
    assert free.push_share == (None, None)


def test_a_foot_whose_heel_is_off_pushes():
    """Only where it has stood for long enough, and less as its ball rises."""
    tiptoe = [[[x, y, z + 0.1 * (x == 0.0)] for x, y, z in FLAT[0]], FLAT[1]]
    assert free_stance(tiptoe, PELVIS, (0.01, 0.01), (1.0, 1.0)).push_share == (PUSH_SHARE, None)
    assert free_stance(tiptoe, PELVIS, (0.01, 0.01), (0.1, 1.0)).push_share == (None, None)
    risen = free_stance(tiptoe, PELVIS, (0.0, 0.01), (1.0, 1.0)).push_share[0]
    assert 0.0 < risen < PUSH_SHARE
