"""Contacts of other parts than the feet in a live run: stretches as those of the whole trial."""

import numpy as np
import pytest

from mbkf.io.contacts import Loads, Source, bearing
from mbkf.trial.live.running_contacts import MOST, RunningContacts

PARTS, RATE_HZ = ("pelvis", "right_hand"), 100.0


def borne(*stretches, frames=200):
    """(T, 2, 6) wrenches; each stretch is a part, its frames and its force."""
    wrench = np.zeros((frames, len(PARTS), 6))
    for part, first, after, force_n in stretches:
        wrench[first:after, part, 2] = force_n
    wrench[5] = np.nan
    return wrench


def in_blocks(wrench, size):
    running = RunningContacts(PARTS, RATE_HZ)
    for first in range(0, len(wrench), size):
        running.add(first, wrench[first : first + size])
    return running.intervals()


@pytest.mark.parametrize("size", [7, 200])
def test_stretches_are_those_of_the_whole_trial(size):
    """Also where a block ends within one; a gap of an instant does not end it, and an instant is no contact."""
    wrench = borne((0, 20, 60, 300.0), (0, 63, 90, 400.0), (1, 80, 150, 50.0), (1, 180, 182, 9.0))
    source = np.where(bearing(wrench), Source.ESTIMATED, Source.NONE)
    loads = Loads(PARTS, source, wrench, np.full(wrench.shape, np.nan), np.zeros((*wrench.shape[:2], 3)))
    expected = loads.intervals(np.arange(len(wrench)) / RATE_HZ, RATE_HZ)
    found = in_blocks(wrench, size)
    assert [(a.part, a.from_s, a.to_s, a.peak_n, a.how) for a in found] == [
        (b.part, b.from_s, b.to_s, b.peak_n, b.how) for b in expected
    ]
    assert [one.peak_n for one in found] == [400.0, 50.0]


def test_nothing_bears():
    assert in_blocks(borne(), 7) == ()


def test_the_number_of_stretches_is_bounded():
    many = [(0, k, k + 6, float(k)) for k in range(0, 20 * MOST, 15)]
    found = in_blocks(borne(*many, frames=20 * MOST + 20), 50)
    assert len(found) == MOST and found[-1].peak_n == many[-1][3]
