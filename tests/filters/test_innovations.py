"""Innovations by kind: chi-square where the trial is coherent, parts of the whole, and above one where it is not."""

import numpy as np
import pytest
from scipy.stats import chi2

from benchmarks.dynamic.nis import nis
from mbkf.conventions import READING_KINDS
from mbkf.filters.filter import Filter
from mbkf.filters.innovations import EXPECTED_FRAMES, LEAST, MOST, InnovationSpreads
from mbkf.numerics.kalman import information
from mbkf.sensors.block import Block, Channels, Frame, Rows
from tests.straight import StraightPlant

DT = 0.01
EMPTY = Frame(np.zeros((0, 3)), np.zeros((0, 6)))


class Points(Block):
    """Reads every number of the state in three coordinates, as markers do."""

    kind = "markers"

    def __init__(self, expected):
        self.expected = expected

    def expected_spread(self):
        return self.expected

    def channels(self, decision):
        return Channels((decision**2).mean(axis=1), np.full(len(decision), 3))

    def decide(self, at, frame, memory, notes):
        return frame.readings["z"] - at.state.q[:, None]

    def linearise(self, at, decision):
        n = len(at.state.q)
        return information(decision.ravel(), np.repeat(np.eye(n), 3, axis=0), np.repeat(self.expected, 3))


class Loads(Block):
    """Whitened forces and moments."""

    kind = "plates"
    quantities = 2

    def decide(self, at, frame, memory, notes):
        return frame.readings["w"]

    def linearise(self, at, decision):
        return Rows(np.zeros((len(decision), 1)), decision, readings=len(decision))


def judged(y, loads=None, expected=1.0):
    """Innovations of frames of points (T, n, 3), and of loads (T, 6)."""
    blocks = [Points(np.full(y.shape[1], expected)), Loads()]
    spreads = InnovationSpreads(blocks, DT)
    before, found = spreads.begin(), []
    for t, points in enumerate(y):
        said = None if loads is None else blocks[1].linearise(None, loads[t])
        read = spreads.read([points, None], [None, said])
        one, before = spreads.innovations(before, read), spreads.after(before, read)
        found.append(one)
    return found


def mean(found, kind):
    k = READING_KINDS.index(kind)
    return sum(one.squared[k] for one in found) / sum(one.readings[k] for one in found)


def test_a_matched_linear_system_is_chi_square():
    """A random walk read in a filter; its own NIS is exactly so, and that against the past spread near it."""
    rng, n, sd, frames = np.random.default_rng(3), 6, 0.5, 600
    plant = StraightPlant(n, sd=0.1)
    kalman = Filter(plant, [Points(np.full(n, sd))])
    state, memory, x = plant.start(), kalman.begin(), rng.normal(size=n)
    exact, found = [], []
    for _ in range(frames):
        x = x + 0.1 * rng.normal(size=n)
        z = x[:, None] + sd * rng.normal(size=(n, 3))
        step = kalman.step(state, memory, EMPTY._replace(readings={"z": z}))
        state, memory = step.state, step.memory
        exact.append(nis(step)[0])
        found.append(step.innovations)
    readings = 3 * n * frames
    low, high = chi2.ppf([0.001, 0.999], readings)
    assert low < sum(exact) < high
    # Its spread is itself known from 60 numbers or so, whose inverse is 3 % large in the mean.
    assert 0.98 < mean(found[50:], "markers") < 1.08


def test_parts_sum_to_the_whole_and_unknown_loads_do_not_count():
    rng = np.random.default_rng(4)
    found = judged(rng.normal(size=(30, 4, 3)), rng.normal(size=(30, 6)))
    np.testing.assert_array_equal(found[0].readings, [12, 0, 0, 0])
    np.testing.assert_array_equal(found[9].readings, [12, 6, 0, 0])
    assert found[9].squared[0] == pytest.approx(3.0 * found[9].markers.sum(), rel=1e-12)


def test_a_frame_is_judged_by_the_frames_before_it():
    y = np.ones((3, 1, 3))
    y[1] = 5.0
    found = judged(y)
    assert found[0].markers[0] == 1.0 and found[1].markers[0] == pytest.approx(25.0)
    grown = (1.0 + (25.0 - 1.0) / (EXPECTED_FRAMES + 2.0)) ** 0.5
    assert found[2].marker_spread_m[0] == pytest.approx(grown, rel=1e-12)


@pytest.mark.parametrize("size", [0.3, 1.0, 2.5])
def test_noise_within_its_range_is_found_from_the_trial(size):
    found = judged(size * np.random.default_rng(5).normal(size=(400, 8, 3)))[50:]
    assert mean(found, "markers") == pytest.approx(1.04, abs=0.05)
    assert np.mean([one.marker_spread_m for one in found]) == pytest.approx(size, rel=0.05)


def test_noise_outside_its_range_is_not_believed():
    for size, bound in ((6.0, MOST), (0.02, LEAST)):
        found = judged(size * np.random.default_rng(6).normal(size=(400, 8, 3)))[250:]
        assert mean(found, "markers") == pytest.approx((size / bound) ** 2, rel=0.05)


def test_a_jump_of_loads_shows_in_their_kind_alone():
    rng = np.random.default_rng(7)
    loads = rng.normal(size=(200, 6))
    loads[150] *= 30.0
    found = judged(rng.normal(size=(200, 4, 3)), loads)
    assert found[150].squared[1] > 300.0 * found[150].readings[1]
    assert mean(found[100:], "markers") == pytest.approx(1.0, abs=0.15)
