"""Joints out of sight: they move on with trunk and legs as they did, and nothing changes while all is seen."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from mbkf.sensors.block import Frame
from mbkf.sensors.coordination.prior import (
    BLOCK_S,
    NOTED_HZ,
    CoordinationMemory,
    CoordinationPrior,
    NotedFrame,
)
from mbkf.synthesis.motion import synthesise_motion
from tests.dynamics import (
    DT,
    block_of,
    camera_markers,
    dynamic_filter,
    memory_of,
    random_state,
    standing,
    trial,
)
from tests.motions import reference_model

pytestmark = pytest.mark.slow

MODEL = reference_model()
LEADING = MODEL.roles.leading
SEEN_S, HIDDEN_S = 2.6, 0.4
ARMS = ("upper_arm", "forearm", "hand")


@cache
def walk():
    """Somebody who walks, with plates under both feet."""
    made = trial("walk")
    return replace(made, motion=synthesise_motion(made.model, "walk", SEEN_S + HIDDEN_S, seed=5))


@cache
def followed(hide=True, **settings):
    """Steps of a filter from which the arms' markers are taken at last."""
    made, rng = walk(), np.random.default_rng(0)
    kalman = made.kalman(**settings)
    markers = camera_markers(kalman, made.motion.q, rng)
    arms = [marker.segment.endswith(ARMS) for marker in made.subject.markers]
    if hide:
        markers[round(SEEN_S / DT) :, arms] = np.nan
    state, memory, steps = made.state(0, rng), kalman.begin(), []
    for seen, load in zip(markers[1:], made.motion.foot_wrench[1:], strict=True):
        steps.append(kalman.step(state, memory, Frame(seen, load)))
        state, memory = steps[-1].state, steps[-1].memory
    return steps


def decided(step):
    """Dofs that a step's prior predicts."""
    return step.decisions.notes.coordinated


def kept(step):
    """What the prior keeps after a step of the walk's filter."""
    return memory_of(walk().kalman(), CoordinationPrior, step.memory)


def prior_of(kalman):
    return block_of(kalman, CoordinationPrior)[0]


def learned(block, memory):
    """What a block has learned before the next frame comes."""
    return block.prepare(None, memory)


def arm_dofs(model):
    return np.concatenate(
        [np.arange(j.v.start, j.v.stop) for n, j in model.joints.items() if n.endswith(ARMS)]
    )


def arm_errors(steps):
    """(n, arm dofs) errors of the arms' posture over the time they are hidden, rad."""
    made, hidden = walk(), range(round(SEEN_S / DT), len(steps))
    pairs = [(steps[t].state.q, made.motion.q[t + 1]) for t in hidden]
    return np.array([made.model.difference(q, truth)[arm_dofs(made.model)] for q, truth in pairs])


def size(errors):
    return float(np.sqrt((errors**2).mean()))


def test_hidden_arms_swing_on():
    error = size(arm_errors(followed()))
    assert error < 0.5 * size(arm_errors(followed(coordination_memory_s=0.0)))
    assert error < np.deg2rad(6.0)


def test_their_stated_spread_is_like_their_error():
    steps, dofs = followed(), arm_dofs(walk().model)
    hidden = steps[round(SEEN_S / DT) :]
    stated = np.array([np.diag(step.state.P)[dofs] for step in hidden])
    assert 0.2 < np.mean(arm_errors(steps) ** 2 / stated) < 3.0


def test_nothing_changes_while_all_is_seen():
    for coordinated, without in zip(
        followed(hide=False), followed(hide=False, coordination_memory_s=0.0), strict=True
    ):
        np.testing.assert_array_equal(coordinated.state.q, without.state.q)
        assert not len(decided(coordinated))


def test_what_goes_out_of_sight_is_learned_once_from_what_was_seen():
    made, first = walk(), round(SEEN_S / DT)
    before, steps = kept(followed()[first - 2]), followed()[first:]
    assert not before.learned
    arms = set(arm_dofs(made.model))
    for step in steps:
        assert set(decided(step)) <= arms & set(step.decisions.notes.unobserved)
    dependents = prior_of(made.kalman()).dependents
    found = kept(steps[-1]).learned
    assert {j for j, own in enumerate(dependents) if arms & set(own)} == set(found)
    assert all(found[j] is kept(steps[0]).learned[j] for j in found)
    noted = kept(steps[-1]).noted[-round(HIDDEN_S * NOTED_HZ) :]
    assert not any(one.observed[list(arms)].any() for one in noted)
    assert all(one.observed[list(arms)].all() for one in before.noted)


def test_a_prediction_begins_a_frame_after_its_joint_has_gone():
    """In that frame there was no time to learn; what comes back is no longer predicted at once."""
    last = round(SEEN_S / DT) - 1
    gone, after = followed()[last : last + 2]
    assert len(gone.decisions.notes.unobserved) and not len(decided(gone))
    assert kept(gone).gone and not kept(gone).learned
    assert len(decided(after))


def test_what_comes_back_is_forgotten_and_what_was_seen_elsewhere_is_learned_by_itself():
    """The second joint was out of sight in the first half of the notes."""
    block, rng = prior_of(dynamic_filter(MODEL)), np.random.default_rng(0)
    first, second = block.dependents[:2]
    noted = []
    for time in range(10):
        seen = np.ones(MODEL.nv, dtype=bool)
        seen[second] = time >= 5
        features = rng.normal(size=len(block.features(standing(MODEL), np.zeros(MODEL.nv))))
        movement = rng.normal(size=2 * MODEL.nv)
        noted += [NotedFrame(time, features, movement, seen)] * 3
    memory = CoordinationMemory(30, tuple(noted), (0, 1), {})
    both = learned(block, memory)
    assert (both[0].relation.blocks, both[1].relation.blocks) == (10, 5)
    assert len(both[0].columns) == 2 * len(first) and len(both[1].columns) == 2 * len(second)
    left = learned(block, memory._replace(gone=(1,), learned={1: both[1]}))
    assert left.keys() == {1} and left[1] is both[1]
    assert not learned(block, memory._replace(gone=()))
    assert not learned(block, block.begin())
    assert not learned(block, None)


def test_memory_ends():
    noted = kept(followed(coordination_memory_s=1.0)[-1]).noted
    assert len(noted) == round(NOTED_HZ)
    assert len({one.block for one in noted}) <= 1.0 / BLOCK_S + 1


def test_features_know_neither_place_nor_heading():
    block, rng = prior_of(dynamic_filter(MODEL)), np.random.default_rng(0)
    state = random_state(MODEL, rng, standing(MODEL))
    moved = state.q.copy()
    moved[:3] += rng.normal(size=3)
    moved[3:7] = (Rotation.from_euler("z", 2.0) * Rotation.from_quat(moved[3:7])).as_quat()
    found = block.features(moved, state.v)
    np.testing.assert_allclose(found, block.features(state.q, state.v), atol=1e-9)


def test_features_know_how_the_pelvis_leans():
    block, q = prior_of(dynamic_filter(MODEL)), standing(MODEL)
    leaning = MODEL.integrate(q, np.r_[np.zeros(3), 0.0, 0.2, 0.0, np.zeros(MODEL.nv - 6)])
    still = np.zeros(MODEL.nv)
    change = block.features(leaning, still) - block.features(q, still)
    assert np.abs(change[:2]).max() == pytest.approx(np.sin(0.2))
    assert np.abs(change[2:]).max() == 0.0


def test_trunk_and_legs_lead_and_what_no_marker_moves_does_not_follow():
    unobservable = np.zeros(MODEL.nv, dtype=bool)
    unobservable[MODEL.joint("head").v] = True
    dependents = np.concatenate(CoordinationPrior(MODEL, DT, unobservable).dependents)
    leading = np.concatenate([np.arange(MODEL.joint(s).v.start, MODEL.joint(s).v.stop) for s in LEADING])
    assert not set(dependents) & set(leading)
    assert set(range(6, MODEL.nv)) - set(leading) - set(dependents) == set(np.flatnonzero(unobservable))


def test_a_body_without_joints_that_follow_is_served():
    """Arms, head and toes carry no marker."""
    unobservable = np.ones(MODEL.nv, dtype=bool)
    for segment in ("pelvis", *LEADING):
        unobservable[MODEL.joint(segment).v] = False
    block = CoordinationPrior(MODEL, DT, unobservable)
    assert block.dependents == []
    assert not learned(block, block.begin())
