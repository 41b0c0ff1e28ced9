"""The smoother that reports share, in a linear world: the textbook's, by Rauch, Tung and Striebel."""

from itertools import pairwise

import numpy as np

from mbkf.filters.estimate import NO_WRENCH, Posterior, Record
from mbkf.filters.filter import Filter
from mbkf.filters.report import StateReport
from mbkf.sensors.block import Block, Frame, Rows
from tests.motions import assert_near
from tests.straight import StraightPlant

N, FRAMES = 3, 12
EMPTY = Frame(np.zeros((0, 3)), np.zeros((0, 6)))


class Reading(Block):
    """z = H q + r with unit noise."""

    H = np.array([[1.0, 0.5, 0.0], [0.0, 1.0, -1.0]])

    def decide(self, at, frame, memory, notes):
        return frame.readings["z"]

    def linearise(self, at, decision):
        return Rows(self.H, decision - self.H @ at.state.q, readings=2)


class LineReport(StateReport):
    """Of numbers on a line, which move no body."""

    def __init__(self, kalman):
        self.kalman = kalman

    def first(self, motion, frame):
        raise NotImplementedError

    def posterior(self, step, before, frame):
        q = step.state.q
        record = Record(step.state, step, None, None)
        return Posterior(q, q, q, NO_WRENCH, None, np.zeros(0, dtype=bool), True, False, record)

    def moved(self, estimate, state, before):
        return estimate._replace(q=state.q, record=estimate.record._replace(state=state, detail=before))

    def spread(self, estimate, torques=True):
        raise NotImplementedError


def run():
    """A filter's report and its estimates of a random walk."""
    rng = np.random.default_rng(0)
    plant = StraightPlant(N, sd=0.3)
    report, state = LineReport(Filter(plant, [Reading()])), plant.start()
    memory, found = report.kalman.begin(), []
    for _ in range(FRAMES):
        step = report.kalman.step(state, memory, EMPTY._replace(readings={"z": rng.normal(size=2)}))
        state, memory = step.state, step.memory
        found.append(report.posterior(step, None, EMPTY))
    return report, found


def textbook(found):
    """Means and covariances from the last frame to the first: G = P P⁻⁻¹ with a transition of 1."""
    x, P = found[-1].q, found[-1].record.state.P
    smoothed = [(x, P)]
    for before, after in zip(found[-2::-1], found[:0:-1], strict=True):
        prior, own = after.record.step.prior.state, before.record.state
        G = own.P @ np.linalg.inv(prior.P)
        x, P = own.q + G @ (x - prior.q), own.P + G @ (P - prior.P) @ G.T
        smoothed.append((x, P))
    return smoothed[::-1]


def test_smoothing_is_the_textbooks():
    report, found = run()
    smoothed = report.smooth(found, FRAMES)
    for one, (x, P) in zip(smoothed, textbook(found), strict=True):
        assert_near(one.q, x, 1e-12)
        assert_near(one.record.state.P, P, 1e-12)


def test_a_part_is_smoothed_in_the_light_of_the_whole_with_the_frame_before_at_hand():
    report, found = run()
    whole, part = report.smooth(found, FRAMES), report.smooth(found, 4)
    assert len(part) == 4 and part[0].record.detail is None
    for one, other in zip(part, whole, strict=False):
        np.testing.assert_array_equal(one.q, other.q)
    for before, after in pairwise(part):
        assert after.record.detail is before.record.state


def test_covariance_of_the_motion_and_no_wrench_by_default():
    report, found = run()
    assert np.isnan(report.wrench_sd(found[0])).all()
