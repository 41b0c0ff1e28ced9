"""The filter of plant and blocks: how statements are summed, what counts as innovation, what is decided anew."""

import numpy as np
import pytest

from benchmarks.dynamic.nis import nis
from mbkf.filters.filter import Filter
from mbkf.numerics.kalman import information
from mbkf.sensors.block import Block, Frame, Rows
from mbkf.sensors.markers import Markers
from mbkf.sensors.newton_euler import NewtonEulerLaw
from mbkf.sensors.planted import PlantedFeet
from tests.dynamics import block_of, dynamic_filter, random_state, standing
from tests.motions import assert_near, reference_model
from tests.straight import StraightPlant, line

N, n = 9, 4
RNG = np.random.default_rng(2)
H, Y, SD = RNG.normal(size=(6, n)), RNG.normal(size=6), RNG.uniform(0.5, 2.0, 6)
PARTS = (
    Rows(RNG.normal(size=(2, N)), RNG.normal(size=2), readings=2),
    Rows(RNG.normal(size=(3, 4)), RNG.normal(size=3), first=5, readings=1),
)
VALUES = np.concatenate([part.innovation for part in PARTS])


class Statements(Block):
    """Says the same in every frame."""

    def __init__(self, statement, prior=False):
        self.statement, self.prior = statement, prior

    def decide(self, at, frame, memory, notes):
        return None

    def linearise(self, at, decision):
        return self.statement


def filter_of(*blocks, size=N):
    return Filter(StraightPlant(size), blocks)


def test_statements_of_all_kinds_are_summed():
    """Information of instruments and priors on few or many components, rows alone and several, and nothing."""
    short, long, belief = (
        information(RNG.normal(size=3), RNG.normal(size=(3, k)), np.ones(3)) for k in (2, 5, 4)
    )
    blocks = [
        Statements(PARTS[0]),
        Statements(short),
        Statements(None),
        Statements(belief, prior=True),
        Statements(list(PARTS)),
        Statements(long),
    ]
    kalman = filter_of(*blocks)
    found = kalman.step(line(N), kalman.begin(), Frame(np.zeros((0, 3)), np.zeros((0, 6)))).readings
    matrix, instruments = np.zeros((N, N)), np.zeros((5, 5))
    for one in (short, long, belief):
        size = len(one.vector)
        matrix[:size, :size] += one.matrix
    for one in (short, long):
        instruments[: len(one.vector), : len(one.vector)] += one.matrix
    for one in (PARTS[0], *PARTS):
        own = np.zeros((len(one.innovation), N))
        own[:, one.first : one.first + one.jacobian.shape[1]] = one.jacobian
        matrix += own.T @ own
    assert_near(found.whole_matrix, matrix, 1e-12)
    assert_near(found.instruments.matrix, instruments, 1e-12)
    assert found.instruments.readings == 6
    assert found.instruments.innovation == short.innovation + long.innovation
    np.testing.assert_array_equal(found.values, np.concatenate([PARTS[0].innovation, VALUES]))
    assert [len(part) for part in found.parts] == [1, 0, 0, 0, 2, 0]


def test_priors_are_no_innovations():
    """They change the state and not what NIS counts."""
    read, belief = Statements(information(Y, H, SD)), Statements(information(Y, H, SD), prior=True)
    alone, both = filter_of(read), filter_of(belief, read)
    empty = Frame(np.zeros((0, 3)), np.zeros((0, 6)))
    first, second = (one.step(line(N), one.begin(), empty) for one in (alone, both))
    assert nis(second)[0] == pytest.approx(nis(first)[0], rel=1e-12)
    assert nis(second)[1] == nis(first)[1] == 6
    assert np.abs(second.state.q - first.state.q).max() > 0.0


class Reviewed(Block):
    """A reading that is taken back where the posterior lies beyond a limit."""

    def __init__(self, value, limit):
        self.value, self.limit = value, limit

    def decide(self, at, frame, memory, notes):
        return True

    def linearise(self, at, decision):
        e = np.eye(N)[:1]
        return Rows(e, self.value - at.state.q[:1], readings=1) if decision else None

    def review(self, posterior, decision):
        return False if posterior.q[0] > self.limit else None

    def remember(self, posterior, at, decision, memory):
        return decision


@pytest.mark.parametrize("value", [1.0, 5.0])
def test_a_decision_that_the_posterior_refutes_is_replaced_once(value):
    block = Reviewed(value, 2.0)
    kalman, silent = filter_of(block), filter_of(Statements(None))
    empty = Frame(np.zeros((0, 3)), np.zeros((0, 6)))
    found = kalman.step(line(N), kalman.begin(), empty)
    stands = 0.5 * value < 2.0
    assert list(found.decisions.blocks) == [stands] == list(found.memory.blocks)
    if not stands:
        without = silent.step(line(N), silent.begin(), empty)
        np.testing.assert_array_equal(found.state.q, without.state.q)
        np.testing.assert_array_equal(found.state.P, without.state.P)
    assert len(found.readings.values) == stands


def test_what_a_block_prepared_is_found_by_its_kind():
    kalman = dynamic_filter(reference_model())
    state = random_state(reference_model(), np.random.default_rng(0), standing(reference_model()), 0.1)
    prior = kalman.predict(state, kalman.begin())
    reading = kalman.prepared_by(Markers, prior)
    np.testing.assert_array_equal(reading.positions_m, kalman.sensor.positions(prior.state.q))
    bare = Filter(kalman.plant, [block_of(kalman, NewtonEulerLaw)[0]])
    with pytest.raises(LookupError, match="PlantedFeet"):
        bare.prepared_by(PlantedFeet, prior._replace(points=prior.points[1:2]))
