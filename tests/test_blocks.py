"""Contract of every block, found by itself and tested alone: silence, order of instruments, noise, the linear case.

That what it says is the derivative of its innovations, tests/test_jacobians.py checks."""

import copy
from dataclasses import fields, is_dataclass

import numpy as np
import pytest

from mbkf.filters.filter import Filter
from mbkf.numerics.kalman import Information
from mbkf.sensors.block import Block, Notes, OperatingPoint
from tests.block_contract import (
    all_rows,
    block_classes,
    noises,
    noisier,
    shown,
    speaks,
    stacked,
    whole,
)
from tests.block_scenes import SILENT, scene, situations_of
from tests.motions import worst

BLOCKS = block_classes()
each_block = pytest.mark.parametrize("name", BLOCKS)

PER_INSTRUMENT = {"BodySensors": "tests/sensors/test_body_sensors.py"}
"""Blocks with states for each instrument, in the instruments' order, and where that order is tested."""


def cases(name):
    """What the block has been shown wherever it speaks."""
    found = [shown(BLOCKS[name], situation) for situation in situations_of(name)]
    return [one for one in found if speaks(one.says())]


def test_the_standard_blocks_and_one_of_the_tests_own_are_found():
    standard = {"Markers", "NewtonEulerLaw", "FootContact", "PlantedFeet", "InertialSensors", "JointLimits"}
    assert {*standard, "CoordinationPrior", "MeanPosture", "PosturePrior", "UnobservedJoints"} <= set(BLOCKS)
    assert "DriftingTracker" in BLOCKS


@each_block
def test_it_speaks_in_some_situation(name):
    assert cases(name), f"{name} says nothing in any of {situations_of(name)}; add one in which it does"


@each_block
def test_a_frame_without_readings_says_nothing_of_readings(name):
    """What is left is what a law or a prior says whatever is read."""
    kind = BLOCKS[name]
    for situation in SILENT:
        found = shown(kind, situation)
        said = found.says()
        rows, values = stacked(said, found.plant.layout.size)
        assert np.isfinite(rows).all() and np.isfinite(values).all()
        counted = said.readings if isinstance(said, Information) else sum(r.readings for r in all_rows(said))
        always = shown(kind, "seen").says()
        if counted and isinstance(said, Information):
            more = np.linalg.eigvalsh(always.matrix - said.matrix)
            assert more.min() >= -1e-9 * more.max(), "nothing is known that readings do not tell as well"
        elif counted:
            known = stacked(always, found.plant.layout.size)[0]
            for row in rows:
                assert (known == row).all(axis=1).any(), "nothing is known that readings do not tell as well"
        at = OperatingPoint(found.state, found.block.prepare(found.state, found.memory))
        found.block.remember(found.state, at, found.decision, found.memory)


@pytest.mark.parametrize("name", [name for name in BLOCKS if name not in PER_INSTRUMENT])
def test_the_order_of_instruments_changes_nothing(name):
    for situation in situations_of(name):
        one, other = (shown(BLOCKS[name], situation, seed) for seed in (None, 1))
        size = one.plant.layout.size
        for mine, theirs in zip(whole(one.says(), size), whole(other.says(), size), strict=True):
            assert worst(mine - theirs) <= 1e-9 * max(worst(mine), 1e-300)


@each_block
def test_twice_the_noise_is_a_quarter_of_the_information(name):
    """Of every row, or of the whole: there is a noise that weighs it."""
    kind, here = BLOCKS[name], scene(None)
    for found in cases(name):
        before = found.says()
        rows, values = stacked(before, found.plant.layout.size)
        quartered = np.zeros(len(values), dtype=bool)
        tried = [(here.made(kind, **change), found.decision) for change in noises(kind, here)]
        tried += [(found.block, decision) for decision in noisier(found.decision)]
        for block, decision in tried:
            after = block.linearise(OperatingPoint(found.state, block.prepare(found.state, None)), decision)
            if isinstance(before, Information):
                quarter = np.allclose(
                    4.0 * after.matrix, before.matrix, rtol=1e-9, atol=1e-9 * worst(rows) ** 2
                )
                quartered |= quarter and np.allclose(4.0 * after.vector, before.vector, rtol=1e-9, atol=1e-9)
            else:
                less, innovation = stacked(after, found.plant.layout.size)
                half = np.isclose(2.0 * less, rows, rtol=1e-9, atol=1e-12).all(axis=1)
                quartered |= half & np.isclose(2.0 * innovation, values, rtol=1e-9, atol=1e-12)
        assert quartered.all()


class Told(Block):
    """Tells the blocks after it what instruments have noted in a frame."""

    def __init__(self, notes):
        self._notes = notes

    def decide(self, at, frame, memory, notes):
        for name in Notes.__annotations__:
            setattr(notes, name, getattr(self._notes, name))

    def linearise(self, at, decision):
        return None


@each_block
def test_alone_in_a_filter_it_is_the_textbook_update(name):
    """K = P Hᵀ (H P Hᵀ + R)⁻¹ with P the predicted covariance, whitened so that R = 1."""
    for found in cases(name):
        kalman = Filter(found.plant, [Told(found.situation.noted()), found.block])
        memory = kalman.begin()._replace(blocks=(None, found.memory))
        state = copy.deepcopy(found.state)
        done = kalman.correct(kalman.prepared(state, None, memory), memory, found.frame)
        P, decision = done.prior.state.P, done.decisions.blocks[1]
        H, y = stacked(found.says(found.state, decision), len(P))
        K = np.linalg.solve(H @ P @ H.T + np.eye(len(y)), H @ P).T
        sd = np.sqrt(np.diag(P))
        step = found.plant.difference(found.state, done.state)
        assert worst((step - K @ y) / sd) < 1e-6 * max(1.0, worst(K @ y / sd))
        assert worst((done.state.P - (P - K @ H @ P)) / sd / sd[:, None]) < 1e-8
        np.testing.assert_array_equal(done.state.P, done.state.P.T)


def arrays_in(thing, depth=0):
    """Arrays within a record, however deep."""
    if isinstance(thing, np.ndarray):
        yield thing
    elif depth < 6 and isinstance(thing, tuple | list):
        for one in thing:
            yield from arrays_in(one, depth + 1)
    elif depth < 6 and is_dataclass(thing):
        for one in fields(thing):
            yield from arrays_in(getattr(thing, one.name), depth + 1)


@each_block
def test_asked_again_it_says_the_same_and_writes_into_nothing_it_was_given(name):
    for situation in (*situations_of(name), *SILENT):
        found = shown(BLOCKS[name], situation)
        notes = found.situation.noted()
        given = (found.state, found.frame[:3], found.memory, found.decision, notes)
        inputs = list(arrays_in(given))
        kept = [one.copy() for one in inputs]
        size, first = found.plant.layout.size, found.says()
        said = [one.copy() for one in stacked(first, size)]
        for block_state in (found.moved(np.full(10, 0.3)), found.state):
            at = OperatingPoint(block_state, found.block.prepare(block_state, found.memory))
            decision = found.block.decide(at, found.frame, found.memory, found.situation.noted())
            found.block.linearise(at, decision)
            found.block.review(block_state, decision)
            found.block.remember(block_state, at, decision, found.memory)
            assert np.isfinite(found.block.log_noise(decision))
        for again in (first, found.says()):
            for now, before in zip(stacked(again, size), said, strict=True):
                np.testing.assert_array_equal(now, before)
        for now, before in zip(inputs, kept, strict=True):
            np.testing.assert_array_equal(now, before)


@each_block
def test_the_process_noise_it_adds_is_a_covariance(name):
    for found in cases(name):
        P = np.zeros((found.plant.layout.size,) * 2)
        found.block.inflate(P, found.decision)
        np.testing.assert_allclose(P, P.T, atol=1e-9 * max(1.0, worst(P)))
        assert np.linalg.eigvalsh(P).min() > -1e-9 * max(1.0, worst(P))
