"""Madgwick's filter: equal to another implementation, live as in one go, many as one; its gains do what they say."""

import numpy as np
import pytest
from ahrs.filters import Madgwick

from mbkf.errors import InvalidInput
from mbkf.imu.frames import attitude
from mbkf.imu.madgwick import MadgwickFilter, MadgwickSettings
from tests.imu.turning import RATE_HZ, apart_deg, turning

DT = 1.0 / RATE_HZ
MADE = turning(8.0)


def course(filter_, gyro, force, field=None, start=None):
    return np.array([state.quaternion for state in filter_.run(gyro, force, field, start)])


@pytest.mark.parametrize("magnetic", [False, True])
@pytest.mark.parametrize("beta", [0.03, 0.1, 0.5])
def test_it_is_the_filter_that_others_know(magnetic, beta):
    field = MADE.field if magnetic else None
    rng = np.random.default_rng(1)
    gyro = MADE.gyro + rng.normal(0.0, 0.02, MADE.gyro.shape)
    # At the very minimum the direction of the step is that of rounding: keep away from it.
    force = MADE.force + rng.normal(0.0, 0.2, MADE.force.shape)
    own = MadgwickFilter(DT, MadgwickSettings(beta))
    start = np.roll(MADE.truth[0], 1)
    other = Madgwick(frequency=RATE_HZ, gain=beta)
    theirs = [start]
    for k in range(1, len(gyro)):
        if magnetic:
            theirs.append(other.updateMARG(theirs[-1], gyro[k], force[k], MADE.field[k]))
        else:
            theirs.append(other.updateIMU(theirs[-1], gyro[k], force[k]))
    mine = course(own, gyro, force, field, own.begin_at(MADE.truth[0]))
    assert apart_deg(mine, np.roll(theirs, -1, axis=1)).max() < 0.02


@pytest.mark.parametrize("magnetic", [False, True])
def test_one_go_live_and_side_by_side_agree(magnetic):
    made = [turning(3.0, seed) for seed in range(3)]
    gyro, force, field = (np.stack([getattr(m, n) for m in made], 1) for n in ("gyro", "force", "field"))
    own = MadgwickFilter(DT, MadgwickSettings(0.1, 0.01))
    together = course(own, gyro, force, field if magnetic else None)
    for n in range(3):
        mag = field[:, n] if magnetic else None
        alone = course(own, gyro[:, n], force[:, n], mag)
        np.testing.assert_allclose(alone, together[:, n], atol=1e-9)
        state = own.begin(force[0, n], None if mag is None else mag[0])
        for k in range(1, len(gyro)):
            state = own.step(state, gyro[k, n], force[k, n], None if mag is None else mag[k])
        np.testing.assert_allclose(state.quaternion, alone[-1], atol=1e-12)


def test_without_correction_it_integrates_the_gyroscope():
    own = MadgwickFilter(DT, MadgwickSettings(0.0))
    found = course(own, MADE.gyro, MADE.force, None, own.begin_at(MADE.truth[0]))
    # First-order steps turn by tan instead of the angle.
    assert apart_deg(found, MADE.truth).max() < 0.1


def test_a_wrong_start_is_corrected_at_the_speed_of_beta():
    still = np.zeros((500, 3))
    force, field = np.tile([0.0, 0.0, 9.8], (500, 1)), np.tile([24.0, 0.0, -39.0], (500, 1))
    off = np.array([np.sin(0.1), 0.0, 0.0, np.cos(0.1)])  # 0.2 rad about x
    own = MadgwickFilter(DT, MadgwickSettings(0.1))
    found = course(own, still, force, field, own.begin_at(off))
    angle = np.radians(apart_deg(found, np.tile([0, 0, 0, 1.0], (500, 1))))
    assert angle[50] == pytest.approx(angle[0] - 2 * 0.1 * 50 * DT, rel=0.1)
    assert angle[-1] < 0.005


def test_zeta_finds_a_constant_bias():
    bias = np.array([0.02, -0.015, 0.01])
    count = 6000
    force, field = np.tile([0.0, 0.0, 9.8], (count, 1)), np.tile([24.0, 0.0, -39.0], (count, 1))
    gyro = np.tile(bias, (count, 1))
    found = list(MadgwickFilter(DT, MadgwickSettings(0.05, 0.003)).run(gyro, force, field))[-1]
    np.testing.assert_allclose(found.gyro_bias, bias, atol=0.004)
    plain = list(MadgwickFilter(DT, MadgwickSettings(0.05)).run(gyro, force, field))[-1]
    assert np.abs(plain.gyro_bias).max() == 0.0


def test_missing_samples_are_bridged():
    gyro, force, field = MADE.gyro.copy(), MADE.force.copy(), MADE.field.copy()
    force[300:320] = np.nan
    field[500:530] = np.nan
    own = MadgwickFilter(DT, MadgwickSettings(0.1))
    found = course(own, gyro, force, field, own.begin_at(MADE.truth[0]))
    whole = course(own, gyro, MADE.force, MADE.field, own.begin_at(MADE.truth[0]))
    assert apart_deg(found, whole).max() < 2.0
    assert np.isfinite(found).all()


def test_the_field_turns_the_heading_north():
    own = MadgwickFilter(DT, MadgwickSettings(0.5))
    force, field = MADE.force[:1].repeat(800, 0), MADE.field[:1].repeat(800, 0)
    found = course(own, np.zeros((800, 3)), force, field, own.begin_at(attitude(force[0])))
    assert apart_deg(found[-1:], MADE.truth[:1])[0] < 0.5


@pytest.mark.parametrize("gains", [(-0.1, 0.0), (0.1, float("nan"))])
def test_gains_that_make_no_sense_are_refused(gains):
    with pytest.raises(InvalidInput, match="0 or more"):
        MadgwickSettings(*gains)
