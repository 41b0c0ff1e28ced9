"""Joints out of sight: they move on with trunk and legs as they did, and nothing changes while all is seen."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from mbkf.filters.dynamic_records import Shown, ShownFrame
from scipy.spatial.transform import Rotation

from mbkf.filters.dynamic.settings import DynamicSettings
from mbkf.sensors.coordination.prior import BLOCK_S, LEADING, SHOWN_HZ, Habit
from mbkf.filters.dynamic_records import Shown, ShownFrame
from mbkf.filters.dynamic.settings import DynamicSettings
from mbkf.sensors.coordination.prior import BLOCK_S, SHOWN_HZ, Habit
from mbkf.synthesis.motion import synthesise_motion
from tests.dynamics import DT, camera_markers, dynamic_filter, random_state, standing, trial
from tests.motions import reference_model

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
        steps.append(kalman.step(state, memory, seen, load))
        state, memory = steps[-1].state, steps[-1].memory
    return steps


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
    assert error < 0.5 * size(arm_errors(followed(habit_memory_s=0.0)))
    assert error < np.deg2rad(6.0)


def test_their_stated_spread_is_like_their_error():
    steps, dofs = followed(), arm_dofs(walk().model)
    hidden = steps[round(SEEN_S / DT) :]
    stated = np.array([np.diag(step.state.P)[dofs] for step in hidden])
    assert 0.2 < np.mean(arm_errors(steps) ** 2 / stated) < 3.0


def test_nothing_changes_while_all_is_seen():
    for with_habit, without in zip(
        followed(hide=False), followed(hide=False, habit_memory_s=0.0), strict=True
    ):
        np.testing.assert_array_equal(with_habit.state.q, without.state.q)
        assert with_habit.decision.expected is None


def test_what_goes_out_of_sight_is_learned_once_from_what_was_seen():
    made, first = walk(), round(SEEN_S / DT)
    before, steps = followed()[first - 2].memory.shown, followed()[first:]
    assert not before.synergies
    arms = set(arm_dofs(made.model))
    for step in steps:
        assert set(step.decision.expected.dofs) <= arms & set(step.decision.unseen)
    followers = made.kalman().habit.followers
    learned = steps[-1].memory.shown.synergies
    assert {j for j, own in enumerate(followers) if arms & set(own)} == set(learned)
    assert all(learned[j] is steps[0].memory.shown.synergies[j] for j in learned)
    noted = steps[-1].memory.shown.noted[-round(HIDDEN_S * SHOWN_HZ) :]
    assert not any(one.seen[list(arms)].any() for one in noted)
    assert all(one.seen[list(arms)].all() for one in before.noted)


def test_a_habit_begins_a_frame_after_what_it_is_of_has_gone():
    """In that frame nobody has had time to learn; what comes back takes its habit with it at once."""
    last = round(SEEN_S / DT) - 1
    gone, after = followed()[last : last + 2]
    assert len(gone.decision.unseen) and gone.decision.expected is None
    assert gone.memory.shown.gone and not gone.memory.shown.synergies
    assert after.decision.expected is not None


def test_what_comes_back_is_forgotten_and_what_was_seen_elsewhere_is_learned_by_itself():
    """The second joint was out of sight in the first half of the notes."""
    kalman, rng = dynamic_filter(MODEL), np.random.default_rng(0)
    habit, memory = kalman.habit, kalman.begin()
    first, second = habit.followers[:2]
    noted = []
    for block in range(10):
        seen = np.ones(MODEL.nv, dtype=bool)
        seen[second] = block >= 5
        features = rng.normal(size=len(habit.features(standing(MODEL), np.zeros(MODEL.nv))))
        movement = rng.normal(size=2 * MODEL.nv)
        noted += [ShownFrame(block, features, movement, seen)] * 3
    shown = Shown(30, tuple(noted), (0, 1), {})
    both = habit.learned(memory._replace(shown=shown))
    assert (both[0].blocks, both[1].blocks) == (10, 5)
    assert len(both[0].targets) == 2 * len(first) and len(both[1].targets) == 2 * len(second)
    kept = habit.learned(memory._replace(shown=shown._replace(gone=(1,), synergies={1: both[1]})))
    assert kept.keys() == {1} and kept[1] is both[1]
    assert not habit.learned(memory._replace(shown=shown._replace(gone=())))
    assert not habit.learned(memory)


def test_memory_ends():
    noted = followed(habit_memory_s=1.0)[-1].memory.shown.noted
    assert len(noted) == round(SHOWN_HZ)
    assert len({one.block for one in noted}) <= 1.0 / BLOCK_S + 1


def test_features_know_neither_place_nor_heading():
    kalman, rng = dynamic_filter(MODEL), np.random.default_rng(0)
    state = random_state(MODEL, rng, standing(MODEL))
    moved = state.q.copy()
    moved[:3] += rng.normal(size=3)
    moved[3:7] = (Rotation.from_euler("z", 2.0) * Rotation.from_quat(moved[3:7])).as_quat()
    found = kalman.habit.features(moved, state.v)
    np.testing.assert_allclose(found, kalman.habit.features(state.q, state.v), atol=1e-9)


def test_features_know_how_the_pelvis_leans():
    kalman, q = dynamic_filter(MODEL), standing(MODEL)
    leaning = MODEL.integrate(q, np.r_[np.zeros(3), 0.0, 0.2, 0.0, np.zeros(MODEL.nv - 6)])
    still = np.zeros(MODEL.nv)
    change = kalman.habit.features(leaning, still) - kalman.habit.features(q, still)
    assert np.abs(change[:2]).max() == pytest.approx(np.sin(0.2))
    assert np.abs(change[2:]).max() == 0.0


def test_trunk_and_legs_lead_and_what_no_marker_moves_does_not_follow():
    held = np.zeros(MODEL.nv, dtype=bool)
    held[MODEL.joint("head").v] = True
    followers = np.concatenate(Habit(MODEL, DT, held, DynamicSettings()).followers)
    leading = np.concatenate([np.arange(MODEL.joint(s).v.start, MODEL.joint(s).v.stop) for s in LEADING])
    assert not set(followers) & set(leading)
    assert set(range(6, MODEL.nv)) - set(leading) - set(followers) == set(np.flatnonzero(held))


def test_it_learns_without_the_follower_that_is_never_there():
    """A body whose arms, head and toes carry no marker has nobody to follow."""
    held = np.ones(MODEL.nv, dtype=bool)
    for segment in ("pelvis", *LEADING):
        held[MODEL.joint(segment).v] = False
    habit = Habit(MODEL, DT, held, DynamicSettings())
    assert habit.followers == []
    assert not habit.learned(dynamic_filter(MODEL).begin()._replace(shown=Shown(0, (), (), {})))
