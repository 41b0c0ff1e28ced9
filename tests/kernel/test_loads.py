"""The kernel states loads as numpy does: forces missing over windows, and spreads of plates' wrenches."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mbkf.conventions import GRAVITY_M_S2
from mbkf.kernel.loading import library
from mbkf.sensors.contact import plate_noise
from mbkf.sensors.contact.plate_noise import PlateNoise
from mbkf.sensors.contact.plates import force_read
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


@pytest.mark.usefixtures("either_kernel")
@pytest.mark.parametrize("missing", [np.nan, np.inf])
def test_forces_of_plates_are_summed_as_far_as_they_are_read(missing):
    plates = np.random.default_rng(5).normal(size=(3, 6))
    finite, force_n = force_read(plates)
    assert finite
    np.testing.assert_allclose(force_n, plates[:, :3].sum(axis=0), rtol=1e-14)
    plates[1, 5] = missing
    assert not force_read(plates)[0]
    plates[0, 2] = np.nan
    finite, force_n = force_read(plates)
    assert not finite
    np.testing.assert_allclose(force_n[2], plates[1:, 2].sum(), rtol=1e-14)
    assert force_read(np.zeros((0, 6)))[0]


@pytest.mark.usefixtures("either_kernel")
def test_noise_of_moments_is_that_about_the_plates_own_origins():
    """Moments of a steady force that moves under it are not steady about the world's origin."""
    origins, rng = np.array([[1.0, 2.0, 0.3], [-2.0, 0.5, 0.0]]), np.random.default_rng(2)
    noise = PlateNoise.before(origins, 3.0, 1.0)
    for _ in range(60):
        force = 500.0 * rng.normal(size=(2, 3))
        noise = noise.after(np.hstack([force, np.cross(origins, force)]))
    assert noise.moment.sd == 0.02
    np.testing.assert_allclose(noise.force.last[-1], force)
    np.testing.assert_allclose(noise.moment.last[-1], 0.0, atol=1e-9)


@needs_kernel
@pytest.mark.parametrize("seed", range(3))
def test_changes_within_a_frame_are_those_of_the_reference(seed, monkeypatch):
    """Beyond the noise with their sign, and zero where noise explains them."""
    change = 10.0 * np.random.default_rng(seed).normal(size=(2, 2, 6))
    change[:, 1, 4] = np.nan
    noise = np.random.default_rng(seed).choice([0.0, 2.0, 8.0], (2, 6))
    found = plate_noise.changes_within(change, noise, (0.005, 0.15))
    monkeypatch.setattr(plate_noise, "library", lambda: None)
    np.testing.assert_allclose(found, plate_noise.changes_within(change, noise, (0.005, 0.15)), rtol=1e-13)
    np.testing.assert_allclose(found[1][noise == 0.0], 0.15 * change[1][noise == 0.0], rtol=1e-13)
    assert (found[1] == 0.0).any() and (found[1][noise == 2.0] != 0.0).any()
