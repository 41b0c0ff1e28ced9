"""The study of the bachelor's thesis: its formulas by the letter, the textbook filter, verdicts that follow numbers."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from benchmarks.madgwick.accuracy import EKF, PLAIN, SMOOTH, SOURCE, TUNED, Accuracy
from benchmarks.madgwick.as_printed import (
    madgwick_as_printed,
    printed_accelerations,
    printed_gains,
    printed_noise,
    printed_rates,
)
from benchmarks.madgwick.behaviour import (
    Behaviour,
    settling_s,
    turning_through_the_lock,
    wrapped_euler_deg,
)
from benchmarks.madgwick.claims import claims, least_angle_deg
from benchmarks.madgwick.first_base import FILTERS, JOINT_ANGLES, FirstBase, skeleton_of
from benchmarks.madgwick.measured import Measured
from benchmarks.madgwick.plain_ekf import PlainSettings, plain_ekf
from benchmarks.madgwick.scenes import FOOT, MOVEMENTS, THIGH, WALKING
from benchmarks.madgwick.third_base import Compared, Sweep, ThirdBase, write_technaid
from benchmarks.madgwick.timing import Times
from mbkf.imu.madgwick import MadgwickSettings
from mbkf.imu.orientation import OrientSettings, orientations
from mbkf.io.amass import SmplMotion
from mbkf.io.imu.files import read_imu
from mbkf.model.human import HumanModel
from mbkf.synthesis.smpl import motion_of_smpl
from tests.imu.turning import RATE_HZ, apart_deg, turning
from tests.smpl_files import waves

MADE = turning(3.0)
ONE = MADE.readings("thigh")


def test_the_filter_by_the_letter_is_ours_and_its_zeta_does_nothing():
    noise = np.random.default_rng(0).normal(
        0.0, 0.01, MADE.gyro.shape
    )  # without errors a step is rounding alone
    one = MADE.readings(gyro=MADE.gyro + noise)
    start = (Rotation.from_rotvec([0.05, 0.0, 0.05]) * Rotation.from_quat(MADE.truth[0])).as_quat()
    settings = OrientSettings("madgwick", madgwick=MadgwickSettings(0.35))
    (ours,) = orientations([one], frame="NWU", settings=settings, start=start[None])
    letter = madgwick_as_printed(one, 0.35, 0.0, start)
    assert apart_deg(letter, ours.quaternion).max() < 1e-5
    moved = apart_deg(madgwick_as_printed(one, 0.35, 0.07, start), letter).max()
    assert 1e-4 < moved < 0.3


def test_printed_rates_are_twice_the_true_ones_and_second_differences_are_right():
    turns = Rotation.from_quat(MADE.truth)
    twice = printed_rates(turns.as_matrix(), 1.0 / RATE_HZ)
    np.testing.assert_allclose(0.5 * twice, MADE.gyro[1:], atol=0.02)
    t = np.arange(10) / RATE_HZ
    places = np.column_stack([3.0 * t**2, t, 0.0 * t])
    np.testing.assert_allclose(printed_accelerations(places, 1.0 / RATE_HZ), [[6.0, 0.0, 0.0]] * 8, atol=1e-8)


def test_printed_gains_draw_the_root_of_the_product():
    rng, slope = np.random.default_rng(0), 1e-3
    still = rng.normal(0.0, 0.16, (60_000, 3)) + slope * np.arange(60_000)[:, None] / 60.0
    flat = printed_gains(still - slope * np.arange(60_000)[:, None] / 60.0, 60.0)
    assert flat.beta == pytest.approx(np.sqrt(0.75 * 0.16), rel=0.01)
    assert printed_gains(still, 60.0).zeta == pytest.approx(np.sqrt(0.75 * slope), rel=0.02)
    assert printed_noise(flat.beta) == pytest.approx(0.16, rel=0.02)


def test_the_textbook_filter_follows_a_turning_sensor_and_finds_a_bias():
    one = ONE.at(ONE.time_s, lambda values, kind: values + (0.02 if kind == "gyr" else 0.0))
    found = plain_ekf(one, PlainSettings(0.1), MADE.truth[0])
    assert apart_deg(found, MADE.truth)[150:].max() < 6.0
    askew = (Rotation.from_rotvec([0.3, 0.0, 0.3]) * Rotation.from_quat(MADE.truth[0])).as_quat()
    late = plain_ekf(ONE, PlainSettings(0.1, start_sd_rad=0.5), askew)
    assert apart_deg(late, MADE.truth)[-1] < 5.0


def test_a_skeleton_goes_onto_our_body_and_comes_back():
    model = HumanModel.scaled()
    made = waves(0.3)
    made[:, 3] = made[:, 6] = made[:, 12] = made[:, 13] = made[:, 14] = (
        0.0  # one joint of the spine, no collars
    )
    made[:, 10:12] = 0.0  # toes have one axis
    trans = np.random.default_rng(0).normal(size=(len(made), 3))
    q = motion_of_smpl(model, SmplMotion(100.0, made, trans)).q
    rotations, places = skeleton_of(model, q)
    np.testing.assert_allclose(rotations, made, atol=1e-9)
    np.testing.assert_allclose(places, trans, atol=1e-9)


def test_tables_as_technaid_exports_them(tmp_path):
    write_technaid(ONE, MADE.truth, tmp_path / "p.csv", tmp_path / "q.csv")
    assert (tmp_path / "q.csv").read_text().splitlines()[0] == " qW , qX , qY , qZ "
    (found,) = read_imu(tmp_path / "p.csv", units={"acc": "m/s2", "gyr": "rad/s", "mag": "uT"}, rate_hz=60.0)
    np.testing.assert_allclose(found.angular_velocity_rad_s, MADE.gyro, atol=1e-7)


def test_settling_and_the_lock():
    assert settling_s(ONE, 2.0) < settling_s(ONE, 0.2)
    pitch = wrapped_euler_deg(turning_through_the_lock().orientation)[:, 1]
    assert 89.0 < pitch.max() <= 90.0


def test_the_least_angle_of_a_difference():
    """Of two unit quaternions whose w differ by d, none are nearer than those about one axis, halfway at w = 0."""
    d = 0.11535
    assert least_angle_deg(d) == pytest.approx(13.22, abs=0.01)
    half = np.radians(0.25 * least_angle_deg(d))
    assert 2.0 * np.sin(half) == pytest.approx(d)


class Made(Accuracy):
    """Errors that the test states."""

    overall = {TUNED: 2.0, SOURCE: 4.0, PLAIN: 2.2, EKF: 1.0, SMOOTH: 0.5}  # noqa: RUF012 (stands for a property)
    by_movement = {  # noqa: RUF012
        (name, movement, sensor): 1.0
        for name in overall
        for movement in MOVEMENTS
        for sensor in (THIGH, FOOT)
    }
    with_worse_sensors = {TUNED: 4.0, PLAIN: 5.0, EKF: 2.0}  # noqa: RUF012
    wrongly_set = {TUNED: (2.0, 4.0), PLAIN: (2.2, 3.0)}  # noqa: RUF012
    by_segment = {"pelvis": 3.0, "torso": 4.0, "right_thigh": 7.0, "right_foot": 8.0}  # noqa: RUF012


def made():
    behaviour = Behaviour(
        {0.1: np.inf, 0.35: 3.0, 1.0: 1.0}, {0.1: 0.1, 0.35: 0.5, 1.0: 2.0}, {WALKING: 1.0}, (40.0, 8.0), (0.06, 1.3),
        1.5, 178.0, 359.0, 12.0, 1e-15, 1e-12,
    )  # fmt: skip
    angles = {(name, joint): 3.0 for name in FILTERS for joint in JOINT_ANGLES}
    sweep = Sweep(0.1, 0.0, 1.0, [(0.1, 0.0, 1.0)])
    beside = [Compared(WALKING, THIGH, np.zeros((2, 15)), 0.01, 5.0, 7.0, 4.0)]
    return Measured(
        Made(0.06, 0.5, {}),
        behaviour,
        Times(10.0, 100.0, 300.0, 0.2, 0.8),
        FirstBase(1e-15, angles, 2.0, 0.01, 0.1, 18),
        None,
        ThirdBase(1e-9, beside, sweep, sweep, sweep, (0.015, 0.015)),
    )


def verdicts(found):
    return {(one.source, one.statement[:20]): one.verdict for one in claims(found)}


def test_verdicts_follow_the_numbers():
    found = made()
    before = verdicts(found)
    assert set(before.values()) == {"reproduced", "differs", "cannot be had"}
    assert len(before) == len(claims(found)) > 30
    changed = {
        ("Summary, 3.3.1, 6", "Madgwick's filter ne"): replace(
            found, times=Times(10.0, 100.0, 300.0, 0.9, 0.8)
        ),
        ("3.2, Madgwick eq. 34", "ζ weighs the gyrosco"): replace(
            found, behaviour=replace(found.behaviour, zeta_change_deg=(1.2, 1.3))
        ),
        ("4.1, Madgwick eqs. 39 to 43", "Angular velocities f"): replace(
            found, first=replace(found.first, rate_factor=1.0)
        ),
        ("5.3.3, figures 32 to 39", "Madgwick and the sen"): replace(
            found, third=replace(found.third, compared=[replace(found.third.compared[0], mean_qw=0.2)])
        ),
    }
    shank = Made(0.06, 0.5, {})
    shank.__dict__["by_segment"] = {**Made.by_segment, "right_shank": 7.5}
    changed["5.3.3", "Thigh and foot are w"] = replace(found, accuracy=shank)
    for claim, other in changed.items():
        after = verdicts(other)
        assert {key for key in before if before[key] != after[key]} == {claim}


def test_without_captures_claims_on_them_cannot_be_had():
    found = {one.source: one.verdict for one in claims(made())}
    assert found["5.3.2, Madgwick eqs. 44 to 48"] == found["5.3.2"] == "cannot be had"
