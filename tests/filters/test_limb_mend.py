"""A limb set right in a state: new, uncorrelated with the rest, which goes on."""

import numpy as np

from mbkf.filters.kinematic.plant import KinematicState
from mbkf.filters.limb_mend import POSE_SD_RAD, VELOCITY_SD_RAD_S, LimbMend, with_limb
from mbkf.model.layout import Layout
from mbkf.model.limbs import limbs
from tests.motions import moderate_pose, reference_model

MODEL = reference_model()
NV = MODEL.nv
DOFS = limbs(MODEL)[0].dofs


def mended(v):
    rng = np.random.default_rng(0)
    before, after = (moderate_pose(MODEL, rng) for _ in range(2))
    root = rng.normal(size=(2 * NV, 2 * NV))
    state = KinematicState(before, rng.normal(size=NV), root @ root.T)
    mend = LimbMend(after, v, DOFS)
    return state, mend, with_limb(MODEL, state, Layout.kinematic(NV), mend)


def test_the_limb_is_new_and_the_rest_goes_on():
    state, mend, found = mended(np.full(len(DOFS), 0.7))
    moved, others = MODEL.difference(state.q, found.q), np.setdiff1d(np.arange(NV), DOFS)
    np.testing.assert_allclose(MODEL.difference(found.q, mend.q)[DOFS], 0.0, atol=1e-9)
    np.testing.assert_allclose(moved[others], 0.0, atol=1e-9)
    np.testing.assert_allclose(found.v[DOFS], 0.7)
    np.testing.assert_allclose(found.v[others], state.v[others])


def test_nothing_of_the_rest_depends_on_it():
    state, _, found = mended(None)
    own = np.concatenate([DOFS, NV + DOFS])
    others = np.setdiff1d(np.arange(2 * NV), own)
    assert not found.P[np.ix_(own, others)].any() and not found.P[np.ix_(others, own)].any()
    spreads = np.repeat([POSE_SD_RAD, VELOCITY_SD_RAD_S], len(DOFS))
    np.testing.assert_allclose(found.P[np.ix_(own, own)], np.diag(spreads**2))
    np.testing.assert_allclose(found.P[np.ix_(others, others)], state.P[np.ix_(others, others)])
    np.testing.assert_allclose(found.v, state.v)
