"""Mean posture: taken while a limb is observed, read beside inertial sensors when it no longer is."""

from types import SimpleNamespace

import numpy as np

from mbkf.sensors.mean_posture import MeanPosture, MeanPostureSettings
from tests.dynamics import DT, notes_of, prepared_at
from tests.motions import assert_near, moderate_pose, reference_model

MODEL = reference_model()
SETTINGS = MeanPostureSettings(mean_posture_s=0.1, mean_posture_sd_rad=0.5)
IMUS = np.zeros((1, 6))
HAND, TOES = (np.arange(MODEL.nv)[MODEL.joint(name).v] for name in ("right_hand", "right_toes"))
NONE = np.zeros(0, dtype=np.intp)


def lived(poses, unobserved=NONE):
    """The block and its memory after it has seen these configurations."""
    block = MeanPosture(MODEL, DT, SETTINGS)
    memory = block.begin()
    for q in poses:
        state = SimpleNamespace(q=q)
        at = prepared_at(block, state)
        decision = block.decide(at, None, memory, notes_of(imus=IMUS, unobserved=unobserved))
        memory = block.remember(state, at, decision, memory)
    return block, memory


def said(q, mean, **notes):
    block = MeanPosture(MODEL, DT, SETTINGS)
    at = prepared_at(block, SimpleNamespace(q=q))
    return block.linearise(at, block.decide(at, None, mean, notes_of(**notes)))


def test_a_posture_that_stays_is_the_mean():
    rng = np.random.default_rng(0)
    first, then = moderate_pose(MODEL, rng), moderate_pose(MODEL, rng)
    _, mean = lived([first, *[then] * 150])
    assert_near(MODEL.difference(then, mean)[6:], 0.0, 1e-5)


def test_joints_out_of_sight_keep_the_mean_they_had():
    rng = np.random.default_rng(1)
    first, then = moderate_pose(MODEL, rng), moderate_pose(MODEL, rng)
    _, mean = lived([first, *[then] * 50], HAND)
    assert_near(MODEL.difference(first, mean)[HAND], 0.0, 1e-12)
    assert np.abs(MODEL.difference(first, mean)[6:]).max() > 0.1


def test_the_mean_is_read_of_unobserved_limbs_only():
    rng = np.random.default_rng(2)
    q, mean = moderate_pose(MODEL, rng), moderate_pose(MODEL, rng)
    found = said(q, mean, imus=IMUS, unobserved=np.concatenate([HAND, TOES]))
    np.testing.assert_allclose(found.innovation, -MODEL.difference(mean, q)[HAND] / 0.5)
    assert found.readings == 0 and found.jacobian.shape == (len(HAND), MODEL.nv)


def test_nothing_is_said_without_sensors_a_mean_or_a_limb_of_its_own():
    q, mean = MODEL.neutral(), moderate_pose(MODEL, np.random.default_rng(3))
    assert said(q, mean, unobserved=HAND) is None
    assert said(q, None, imus=IMUS, unobserved=HAND) is None
    assert said(q, mean, imus=IMUS) is None
    assert said(q, mean, imus=IMUS, unobserved=TOES) is None
    assert said(q, mean, imus=IMUS, unobserved=HAND, coordinated=HAND) is None
