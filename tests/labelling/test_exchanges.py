"""Exchanged names: found where they are, and nowhere else."""

import time

import numpy as np
import pytest

from mbkf.labelling.exchanges import (
    Distances,
    body_distances,
    find_exchanges,
    observed_distances,
    undo_exchanges,
)
from mbkf.model.clinical import dof_names
from mbkf.model.protocol import load_protocol
from tests.labelling.bodies import posture, reference_sensor

FRAMES = 80
PLACED_M = np.full(36, 0.005)


def walking(frames=FRAMES, seed=0):
    """(T, M, 3) markers of a body that walks 1.2 m/s and swings all joints, with noise."""
    rng = np.random.default_rng(seed)
    sensor = reference_sensor()
    model, swing = sensor.model, np.zeros(sensor.model.nv)
    swing[6:] = rng.uniform(-0.25, 0.25, model.nv - 6)
    q, positions = posture(model, rng, swing_rad=0.05), []
    for t in range(frames):
        now = model.integrate(q, np.sin(2.0 * np.pi * t / 100.0) * swing)
        now[0] += 0.012 * t
        positions.append(sensor.positions(now))
    return np.array(positions) + rng.normal(0.0, 0.001, (frames, len(sensor.segments), 3))


@pytest.fixture(scope="module")
def expected():
    return body_distances(reference_sensor(), PLACED_M)


NAMES = tuple(m.name for m in load_protocol("reference36").markers if m.kind != "computed")


def swapped(positions, a, b, frames):
    changed = positions.copy()
    changed[np.ix_(frames, [a, b])] = positions[np.ix_(frames, [b, a])]
    return changed


def frames_of(*runs):
    there = np.zeros(FRAMES, dtype=bool)
    for first, end in runs:
        there[first:end] = True
    return there


def test_distances_within_a_segment_are_exact_and_vary_by_placement_only(expected):
    sensor = reference_sensor()
    same = np.array([[a == b for a in sensor.segments] for b in sensor.segments])
    apart = np.linalg.norm(sensor.local_m[:, None] - sensor.local_m, axis=2)
    assert np.allclose(expected.expected_m[same], apart[same])
    assert np.allclose(expected.sd_m[same], np.hypot(0.005, 0.005))
    assert (expected.sd_m[~same] > np.hypot(0.005, 0.005)).all()


@pytest.mark.parametrize("seed", range(4))
def test_nothing_is_exchanged_in_a_clean_capture(seed, expected):
    positions = walking(seed=seed)
    assert find_exchanges(positions, expected) == ()
    positions[np.random.default_rng(seed).random(positions.shape[:2]) < 0.2] = np.nan
    assert find_exchanges(positions, expected) == ()


@pytest.mark.parametrize("pair", [("RMT1", "RMT5"), ("RKNE", "RANK"), ("LHEE", "RHEE"), ("C7", "CLAV")])
@pytest.mark.parametrize("runs", [[(20, 45)], [(0, 10), (30, 33), (60, 80)], [(0, FRAMES)]])
def test_exchanged_names_are_found_in_their_frames_and_put_right(pair, runs, expected):
    a, b = sorted(NAMES.index(name) for name in pair)
    positions, there = walking(), frames_of(*runs)
    changed = swapped(positions, a, b, there)
    found = find_exchanges(changed, expected)
    assert [(one.a, one.b) for one in found] == [(a, b)]
    assert np.array_equal(found[0].frames, there)
    assert np.array_equal(undo_exchanges(changed, found), positions)


def test_an_exchange_after_a_gap_is_found(expected):
    a, b = NAMES.index("RKNE"), NAMES.index("LKNE")
    positions = walking()
    positions[30:35, [a, b]] = np.nan
    changed = swapped(positions, a, b, frames_of((35, FRAMES)))
    assert np.array_equal(
        undo_exchanges(changed, find_exchanges(changed, expected)), positions, equal_nan=True
    )


@pytest.mark.parametrize("pair", [("RHEE", "RMT1"), ("C7", "CLAV"), ("RANK", "RKNE")])
def test_one_marker_alone_is_not_renamed(pair, expected):
    """What stands near another's place while that is hidden may be a limb that is bent further than usual."""
    a, b = sorted(NAMES.index(name) for name in pair)
    positions, there = walking(), frames_of((30, 60))
    positions[there, a] = positions[there, b]
    positions[there, b] = np.nan
    found = find_exchanges(swapped(positions, a, b, frames_of((5, 15))), expected)
    assert [(one.a, one.b) for one in found] == [(a, b)]
    assert np.array_equal(found[0].frames, frames_of((5, 15)))


def test_three_names_that_go_round_are_put_right(expected):
    three = [NAMES.index(name) for name in ("RASI", "RKNE", "RANK")]
    positions = walking()
    changed = positions.copy()
    changed[20:50, three] = positions[20:50, np.roll(three, 1)]
    assert np.array_equal(undo_exchanges(changed, find_exchanges(changed, expected)), positions)


def test_markers_that_moved_since_scaling_are_not_exchanged(expected):
    positions = walking()
    rng = np.random.default_rng(1)
    off = expected.expected_m + rng.normal(0.0, 0.01, expected.expected_m.shape)
    assert find_exchanges(positions, Distances(0.5 * (off + off.T), expected.sd_m)) == ()


def test_the_capture_s_own_distances_are_those_of_most_of_its_frames(expected):
    positions = walking()
    a, b = NAMES.index("RKNE"), NAMES.index("RANK")
    changed = swapped(positions, a, b, frames_of((20, 45)))
    seen, true = observed_distances(changed, expected), observed_distances(positions, expected)
    rigid = true.sd_m[a] < 0.015
    assert np.count_nonzero(rigid) >= 3
    assert np.abs(seen.expected_m - true.expected_m)[a, rigid].max() < 0.005
    assert (seen.sd_m <= expected.sd_m).all()


def test_what_shows_too_little_is_left_alone(expected):
    assert find_exchanges(np.full((0, 36, 3), np.nan), expected) == ()
    assert find_exchanges(np.full((5, 36, 3), np.nan), expected) == ()


def test_a_thousand_frames_take_a_fraction_of_a_second(expected):
    positions = np.tile(walking(), (13, 1, 1))[:1000]
    begin = time.perf_counter()
    find_exchanges(positions, expected)
    assert time.perf_counter() - begin < 1.0


def crouching(frames):
    """(T, M, 3) markers of a body that bends hips and knees by 80° for a moment, with noise."""
    sensor, rng = reference_sensor(), np.random.default_rng(0)
    model, names, bent = sensor.model, dof_names(sensor.model), np.zeros(sensor.model.nv)
    for side in ("right", "left"):
        bent[names.index(f"{side}_thigh_y")], bent[names.index(f"{side}_shank_y")] = -1.4, 1.5
    depth = (0.5 - 0.5 * np.cos(2.0 * np.pi * np.arange(frames) / frames)) ** 4
    positions = [sensor.positions(model.integrate(model.neutral(), share * bent)) for share in depth]
    return np.array(positions) + rng.normal(0.0, 0.001, (frames, len(sensor.segments), 3))


@pytest.mark.parametrize("hidden", [["RASI"], ["RASI", "LASI"], ["RASI", "SACR"]])
def test_hips_bent_further_than_usual_between_two_gaps_are_no_exchange(hidden, expected):
    """Distances from pelvis to knees then speak for the other side's name, but nothing has turned over the gaps."""
    positions, gone = crouching(240), [NAMES.index(name) for name in hidden]
    for gap in (slice(97, 100), slice(140, 143)):
        positions[gap, gone] = np.nan
    assert find_exchanges(positions, expected) == ()
