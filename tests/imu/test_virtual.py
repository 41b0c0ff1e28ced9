"""Virtual sensors read what a moving body's points do, and their errors are those asked for."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from mbkf.conventions import GRAVITY_M_S2
from mbkf.errors import InvalidInput
from mbkf.imu.placement import typical_mounts
from mbkf.imu.virtual import FIELD_UT, ImuErrors, virtual_imus
from mbkf.model.human import HumanModel

pytestmark = pytest.mark.slow

MODEL = HumanModel.scaled()
RATE = 200.0


def swinging(seconds=2.0):
    """A motion along one tangent direction from neutral: q(t) = neutral ⊕ s(t) d."""
    t = np.arange(round(seconds * RATE) + 1) / RATE
    d = np.random.default_rng(2).normal(0.0, 0.4, MODEL.nv)
    s, rate, second = np.sin(4 * t), 4 * np.cos(4 * t), -16 * np.sin(4 * t)
    # Spherical and free joints: a fixed axis, so that velocity and acceleration are plain multiples of d.
    d[:3] = 0.0
    q = np.array([MODEL.integrate(MODEL.neutral(), x * d) for x in s])
    return t, q, rate[:, None] * d, second[:, None] * d


def test_they_read_what_finite_differences_of_the_motion_say():
    t, q, v, a = swinging()
    mounts = typical_mounts(MODEL, seed=0)
    for one in virtual_imus(MODEL, t, q, v, a, mounts, errors=ImuErrors.none()):
        turned = Rotation.from_quat(one.orientation)
        between = (turned[:-1].inv() * turned[1:]).as_rotvec() * RATE
        middle = 0.5 * (one.angular_velocity_rad_s[1:] + one.angular_velocity_rad_s[:-1])
        np.testing.assert_allclose(middle, between, atol=0.03)
        mount = next(m for m in mounts if m.name == one.name)
        joint = MODEL.joint(mount.segment).joint_id
        places = []
        for x in q:
            R, p = MODEL.placements(x)
            places.append(p[joint] + R[joint] @ np.array(mount.position_m))
        force = np.diff(places, 2, axis=0) * RATE**2 + [0.0, 0.0, GRAVITY_M_S2]
        np.testing.assert_allclose(turned[1:-1].apply(one.specific_force_mps2[1:-1].copy()), force, atol=0.05)
        np.testing.assert_allclose(
            turned.apply(one.magnetic_field.copy()), np.tile(FIELD_UT, (len(t), 1)), atol=1e-9
        )


def test_another_rate_reads_the_same_motion():
    t, q, v, a = swinging()
    mounts = typical_mounts(MODEL)
    own = virtual_imus(MODEL, t, q, v, a, mounts, errors=ImuErrors.none())
    slow = virtual_imus(MODEL, t, q, v, a, mounts, errors=ImuErrors.none(), rate_hz=50.0)
    for fine, coarse in zip(own, slow, strict=True):
        assert coarse.rate_hz == pytest.approx(50.0)
        np.testing.assert_allclose(coarse.specific_force_mps2, fine.specific_force_mps2[::4], atol=1e-6)
        np.testing.assert_allclose(coarse.angular_velocity_rad_s, fine.angular_velocity_rad_s[::4], atol=1e-6)


def test_errors_have_their_size_and_biases_belong_to_the_sensor():
    t = np.arange(20001) / RATE
    q, zero = np.tile(MODEL.neutral(), (len(t), 1)), np.zeros((len(t), MODEL.nv))
    mounts = typical_mounts(MODEL, ("pelvis",))
    errors = ImuErrors(gyro_drift=0.0)
    (one,) = virtual_imus(MODEL, t, q, zero, zero, mounts, errors=errors, seed=3)
    assert one.angular_velocity_rad_s.std(axis=0) == pytest.approx(errors.gyro_noise * RATE**0.5, rel=0.05)
    assert one.specific_force_mps2.std(axis=0) == pytest.approx(
        errors.accelerometer_noise * RATE**0.5, rel=0.05
    )
    (short,) = virtual_imus(
        MODEL, t[:4000], q[:4000], zero[:4000], zero[:4000], mounts, errors=errors, seed=3
    )
    bias, again = (x.angular_velocity_rad_s.mean(axis=0) for x in (one, short))
    np.testing.assert_allclose(bias, again, atol=5 * errors.gyro_noise)
    assert np.abs(bias).max() > 1e-3
    (other,) = virtual_imus(MODEL, t, q, zero, zero, mounts, errors=errors, seed=4)
    assert np.abs(other.angular_velocity_rad_s.mean(axis=0) - bias).max() > 1e-3


def test_readings_beyond_the_range_are_clipped():
    t, q, v, a = swinging()
    errors = ImuErrors(gyro_range_rad_s=0.5, accelerometer_range_mps2=9.0)
    for one in virtual_imus(MODEL, t, q, v, a, typical_mounts(MODEL), errors=errors):
        assert np.abs(one.angular_velocity_rad_s).max() <= 0.5
        assert np.abs(one.specific_force_mps2).max() <= 9.0


def test_what_makes_no_sense_is_refused():
    t, q, v, a = swinging(0.1)
    a = a.copy()
    a[3] = np.nan
    with pytest.raises(InvalidInput, match="every frame tracked"):
        virtual_imus(MODEL, t, q, v, a, typical_mounts(MODEL))
    with pytest.raises(InvalidInput, match="gyro_noise"):
        ImuErrors(gyro_noise=-1.0)
