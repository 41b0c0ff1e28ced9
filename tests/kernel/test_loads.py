"""The kernel states loads as numpy does: forces missing over windows, and spreads of plates' wrenches."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mbkf.conventions import GRAVITY_M_S2
from mbkf.kernel.loading import library
from mbkf.sensors.contact import plate_noise
from mbkf.sensors.contact.plate_noise import PlateNoise
from mbkf.trial.loads import running
from mbkf.trial.loads.running import RunningBalance

needs_kernel = pytest.mark.skipif(library() is None, reason="the kernel is not compiled here")


@needs_kernel
@pytest.mark.parametrize("level", [False, True])
@pytest.mark.parametrize("frames", [10, 60, 300])
def test_missing_forces_over_full_windows_are_those_of_the_reference(frames, level, monkeypatch):
    rng, balance = np.random.default_rng(frames), RunningBalance(70.0, 100.0)
    for _ in range(frames):
        force = rng.normal(size=3)
        force[2] += 70.0 * GRAVITY_M_S2
        force[0] += level * 0.2 * force[2]
        balance.push(np.array([0.1, 0.2, 1.0]) + 0.01 * rng.normal(size=3), force, judged=True)
    found = balance._missing()
    monkeypatch.setattr(running, "library", lambda: None)
    for one, other in zip(found, balance._missing(), strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-9, atol=1e-9 * np.abs(other).max(initial=1.0))


@needs_kernel
@settings(max_examples=30, deadline=None)
@given(st.integers(0, 10**6), st.integers(0, 4))
def test_spreads_on_feet_are_those_of_the_reference(seed, plates):
    rng = np.random.default_rng(seed)
    noise, soles = PlateNoise.before(rng.normal(size=(plates, 3)), 2.0, 0.5), rng.normal(size=(2, 3))
    found = noise.on_feet(soles)
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(plate_noise, "library", lambda: None)
        np.testing.assert_allclose(found, noise.on_feet(soles), rtol=1e-13)
