"""Compiled contact decisions are those that are stated in Python, frame after frame, with their memories."""

from dataclasses import fields
from functools import lru_cache
from unittest.mock import patch

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mbkf.conventions import GRAVITY_M_S2
from mbkf.kernel.contact_functions import ContactLimits
from mbkf.kernel.loading import library
from mbkf.sensors.contact import compiled, rules
from mbkf.sensors.contact.causal import ContactDetector
from mbkf.sensors.contact.compiled import CompiledContact
from mbkf.sensors.contact.records import Contact
from mbkf.sensors.contact.soles import sole_points
from tests.dynamics import DT, half_weight, plate, standing, trial
from tests.motions import random_model, reference_model

pytestmark = pytest.mark.skipif(library() is None, reason="the kernel is not compiled here")

ROUNDING = 1e-9


def stated(model, plates, dt_s):
    """A detector that decides in Python."""
    with patch.object(CompiledContact, "where_built", return_value=None):
        return ContactDetector(model, plates, dt_s)


def assert_same(found, expected):
    """Records and numbers agree: whole numbers exactly, others to rounding."""
    if isinstance(expected, (float, np.ndarray)):
        size = np.abs(np.nan_to_num(np.asarray(expected), posinf=0.0)).max(initial=1.0)
        np.testing.assert_allclose(found, expected, rtol=0, atol=ROUNDING * size)
    elif isinstance(expected, (tuple, list)):
        assert len(found) == len(expected)
        for one, other in zip(found, expected, strict=True):
            assert_same(one, other)
    elif hasattr(expected, "__dataclass_fields__"):
        for field in fields(expected):
            if field.name != "memory":
                assert_same(getattr(found, field.name), getattr(expected, field.name))
    else:
        assert found == expected


def assert_decided_alike(model, plates, dt_s, frames):
    """Over frames (q, v, a, loads, supported); the kinds that were met."""
    compiled, python = ContactDetector(model, plates, dt_s), stated(model, plates, dt_s)
    ours, theirs, met = compiled.begin(), python.begin(), []
    for q, v, a, loads, supported in frames:
        found = compiled.decide(ours, q, v, a, loads, supported)
        expected = python.decide(theirs, q, v, a, loads, supported)
        assert_same(found, expected)
        assert not found.memory.numbers.flags.writeable
        assert_same(found.memory.numbers, expected.memory.packed(found.memory.window).numbers)
        ours, theirs = found.memory, expected.memory
        met.append(expected)
    return met


def frames_of(made, loads):
    return zip(made.motion.q, made.motion.v, made.motion.a, loads, [False] * len(loads), strict=True)


@pytest.mark.parametrize("name", ["walk", "jump"])
@pytest.mark.parametrize("readings", ["both", "one", "silent", "shared", "none"])
def test_movements_are_decided_as_in_python(name, readings):
    made = trial(name)
    loads, plates = made.motion.foot_wrench.copy(), made.plates
    if readings == "one":
        loads, plates = loads[:, :1], plates[:1]
    elif readings == "silent":
        loads[len(loads) // 3 :, 1] = np.nan
    elif readings == "shared":
        loads, plates = loads.sum(axis=1, keepdims=True), (plate(0.0, 0.0, (6.0, 6.0)),)
    elif readings == "none":
        loads, plates = loads[:, :0], ()
    met = assert_decided_alike(made.model, plates, DT, frames_of(made, loads))
    wanted = {
        "both": Contact.MEASURED,
        "one": Contact.UNMEASURED,
        "silent": Contact.UNMEASURED,
        "shared": Contact.SHARED,
        "none": Contact.UNMEASURED,
    }
    assert any(wanted[readings] in one.contacts for one in met)


def test_a_belt_is_found_alike():
    """A person who stands on a belt, then glides with the pelvis, too."""
    model = reference_model()
    q, v = standing(model), np.zeros(model.nv)
    belt, loads = np.array([0.0, -1.5]), np.zeros((0, 6))
    frames = []
    for t in range(210):
        moved = v.copy()
        moved[:2] = belt
        frames.append((q.copy(), moved, np.zeros(model.nv), loads, False))
        if t > 100:
            q = q.copy()
            q[:2] += DT * belt
    met = assert_decided_alike(model, (), DT, frames)
    moving = [one.floor_m_s != (0.0, 0.0) for one in met]
    assert any(moving) and not moving[0] and not moving[-1]


@pytest.mark.parametrize("share, held", [(0.38, True), (0.42, False)])
def test_a_body_is_held_up_alike(share, held):
    """Predicted to fall, its feet too fast to stand, its pelvis falls with less or more than the limit of 0.4 g."""
    met = assert_decided_alike(reference_model(), (), DT, falling_body(share))
    assert (Contact.UNMEASURED in {kind for one in met for kind in one.contacts}) == held


def falling_body(share):
    """Frames of a body above no plate whose pelvis falls with a share of gravity, feet too fast to stand."""
    model = reference_model()
    q, v, a = standing(model), np.zeros(model.nv), np.zeros(model.nv)
    v[2], a[2] = -5.0, -GRAVITY_M_S2
    for t in range(20):
        lower = q.copy()
        lower[2] -= 0.5 * share * GRAVITY_M_S2 * (t * DT) ** 2
        yield lower, v, a, np.zeros((0, 6)), False


@given(st.integers(0, 10**6))
@settings(max_examples=40, deadline=None)
def test_any_situations_are_decided_as_in_python(seed):
    """Bodies, plates with and without outlines under and beside them, readings and motions of every size."""
    rng = np.random.default_rng(seed)
    model = random_model(rng) if seed % 5 == 0 else reference_model()
    q, dt_s = standing(model), rng.choice([0.002, 0.01, 0.04])
    middles = sole_points(model, q[None])[0].mean(axis=1)
    plates = [
        plate(
            *(middles[rng.integers(2), :2] + rng.normal(0.0, 0.1, 2)),
            rng.uniform(0.05, 0.5, 2),
            outline=outline,
        )
        for outline in rng.random(rng.integers(0, 4)) < 0.6
    ]
    assert_decided_alike(model, plates, dt_s, _anyhow(rng, model, q, dt_s, len(plates)))


def _anyhow(rng, model, q, dt_s, plates):
    """Frames of a body that moves near the floor, its plates loaded, unloaded, hardly loaded or silent for a while."""
    q = model.integrate(
        q, np.concatenate([[0, 0, rng.normal(0.0, 0.03)], rng.normal(0.0, 0.1, model.nv - 3)])
    )
    speed, states = 10.0 ** rng.uniform(-2.0, 0.7), rng.integers(0, 4, plates)
    supported = False
    for _ in range(25):
        v, a = rng.normal(0.0, speed, model.nv), rng.normal(0.0, 10.0, model.nv)
        a[2] -= rng.choice([0.0, 9.81])
        states = np.where(rng.random(plates) < 0.2, rng.integers(0, 4, plates), states)
        points = sole_points(model, q[None])[0].mean(axis=1) + rng.normal(0.0, 0.05, (2, 3))
        on = half_weight(model, points)
        loads = np.array(
            [(on[rng.integers(2)], np.zeros(6), 0.02 * on[0], np.full(6, np.nan))[state] for state in states]
        ).reshape(plates, 6)
        supported ^= rng.random() < 0.1
        yield q, v, a, loads, supported
        q = model.integrate(q, dt_s * v)


def decided(model, plates, frames):
    """Decisions of the kernel over frames, with their memories."""
    detector = ContactDetector(model, plates, DT)
    memory, found = detector.begin(), []
    for q, v, a, loads, supported in frames:
        one = detector.decide(memory, q, v, a, loads, supported)
        memory = one.memory
        found.append((one.contacts, one.floor_m_s, one.near, memory.numbers.tobytes()))
    return found


@lru_cache(None)
def scenes():
    """Bodies, plates and frames in which every limit of the causal decision matters."""
    walk, found = trial("walk"), []
    loads = walk.motion.foot_wrench
    one, none = loads[:, :1], loads[:, :0]
    shared = loads.sum(axis=1, keepdims=True)
    for readings, plates in (
        (loads, walk.plates),
        (one, walk.plates[:1]),
        (shared, (plate(0.0, 0.0, (6.0, 6.0)),)),
        (none, ()),
    ):
        found.append((walk.model, plates, tuple(frames_of(walk, readings))))
    model = reference_model()
    for seed in range(40):
        rng = np.random.default_rng(seed)
        q = standing(model)
        middle = sole_points(model, q[None])[0].mean(axis=1)[0, :2]
        plates = (plate(*middle),)
        found.append((model, plates, tuple(_anyhow(rng, model, q, DT, 1))))
        found.append((model, (), tuple(_anyhow(rng, model, q, DT, 0))))
    return found + [(model, (), tuple(falling_body(share))) for share in (0.3, 0.38, 0.5)]


@lru_cache(None)
def decided_with_all_limits():
    """Decisions in every scene, limits as they are."""
    return [decided(*scene) for scene in scenes()]


@pytest.mark.parametrize("limit", ContactLimits._fields)
def test_each_limit_matters_under_its_own_name(limit):
    """A kernel with half or twice the limit decides otherwise somewhere."""
    true = decided_with_all_limits()
    for factor in (0.5, 2.0):
        other = rules.LIMITS._replace(**{limit: factor * getattr(rules.LIMITS, limit)})
        with patch.object(compiled, "LIMITS", other):
            found = zip(scenes(), true, strict=True)
            assert any(decided(*scene) != before for scene, before in found), f"{factor} {limit}"


def test_a_memory_that_is_longer_than_its_window_is_refused():
    made = trial("walk")
    python, m = stated(made.model, made.plates, DT), made.motion
    memory = python.begin()
    for t in range(60):
        memory = python.decide(memory, m.q[t], m.v[t], m.a[t], m.foot_wrench[t]).memory
        assert memory.packed(100).foot_of_plate == memory.foot_of_plate
    with pytest.raises(ValueError, match="broadcast"):
        memory.packed(50)
