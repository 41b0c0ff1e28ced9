"""Two independent pendulums are one: natural coordinates with CasADi, and Pinocchio, to 1e-9."""

import numpy as np
import pytest

from benchmarks.double_pendulum.pendulum import DoublePendulum, PendulumShape
from benchmarks.double_pendulum.pinocchio_pendulum import PinocchioPendulum

PARTS = ("a", "by_q", "by_v", "by_u")


def both(residual, **shape):
    return [make(PendulumShape(**shape), residual) for make in (DoublePendulum, PinocchioPendulum)]


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("residual", [True, False])
def test_accelerations_and_derivatives_agree(residual, seed):
    rng = np.random.default_rng(seed)
    mine, theirs = both(residual, mass_2_kg=35.0, length_m=0.6)
    q, v, u = rng.normal(size=4), 3.0 * rng.normal(size=4), 300.0 * rng.normal(size=mine.nu)
    ours, others = mine.linearise(q, v, u), theirs.linearise(q, v, u)
    for part in PARTS:
        scale = np.abs(getattr(ours, part)).max()
        np.testing.assert_allclose(getattr(others, part), getattr(ours, part), atol=1e-9 * scale)
    np.testing.assert_allclose(theirs.acceleration(q, v, u), ours.a, rtol=1e-9)


@pytest.mark.parametrize("seed", range(4))
def test_efforts_agree(seed):
    rng = np.random.default_rng(seed)
    mine, theirs = both(residual=True)
    q, v, a = rng.normal(size=4), 3.0 * rng.normal(size=4), 10.0 * rng.normal(size=4)
    np.testing.assert_allclose(theirs.efforts(q, v, a), mine.efforts(q, v, a), rtol=1e-9, atol=1e-9)
