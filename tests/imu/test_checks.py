"""Every fault is told by its kind with a fix; sound readings are not accused."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.conventions import GRAVITY_M_S2
from mbkf.errors import InvalidInput
from mbkf.imu.checks import problems, refuse_fatal
from mbkf.io.imu.readings import ImuReadings
from tests.imu.turning import RATE_HZ, turning

MADE = turning(12.0, rate_rad_s=2.0)
NOISE = np.random.default_rng(0).normal(0.0, 0.01, MADE.gyro.shape)
SOUND = MADE.readings(gyro=MADE.gyro + NOISE, force=MADE.force + NOISE, field=MADE.field + NOISE)


def kinds(*readings):
    return [problem.kind for problem in problems(readings)]


def test_sound_readings_are_not_accused():
    assert problems([SOUND, replace(SOUND, name="b")]) == ()


@pytest.mark.parametrize(
    ("gyro", "force", "kind", "fix"),
    [
        (180.0 / np.pi, 1.0, "unit", "--units gyr=deg/s"),
        (np.pi / 180.0, 1.0, "unit", "--units gyr=rad/s"),
        (-1.0, 1.0, "sign", "reversed"),
        (1.0, 1.0 / GRAVITY_M_S2, "unit", "--units acc=g"),
        (1.0, 1000.0 / GRAVITY_M_S2, "unit", "--units acc=mg"),
        (1.0, GRAVITY_M_S2, "unit", "--units acc=m/s2"),
        (1.0, 0.01, "unit", "gravity was taken away"),
        (1.0, 3.0, "unit", "check its unit"),
    ],
)
def test_wrong_units_are_told_with_the_fix(gyro, force, kind, fix):
    one = replace(
        SOUND,
        angular_velocity_rad_s=gyro * SOUND.angular_velocity_rad_s,
        specific_force_mps2=force * SOUND.specific_force_mps2,
    )
    (problem,) = problems([one])
    assert (problem.kind, problem.fatal) == (kind, True)
    assert fix in problem.text
    with pytest.raises(InvalidInput, match="sensor a"):
        refuse_fatal([problem])


def test_gaps_are_told_and_bridged():
    force = SOUND.specific_force_mps2.copy()
    force[300:325] = np.nan
    (problem,) = problems([replace(SOUND, specific_force_mps2=force)])
    assert problem.kind == "gap"
    assert "0.25 s at 3.00 s" in problem.text
    assert refuse_fatal([problem]) == (problem.text,)


def test_lost_rows_are_told():
    keep = np.delete(np.arange(SOUND.samples), range(400, 450))
    one = ImuReadings(
        "a",
        SOUND.time_s[keep],
        SOUND.specific_force_mps2[keep],
        SOUND.angular_velocity_rad_s[keep],
        None,
        RATE_HZ,
    )
    (problem,) = problems([one])
    assert problem.kind == "gap"
    assert "4.99 s" in problem.text or "3.99 s" in problem.text


@pytest.mark.parametrize("channel", ["specific_force_mps2", "angular_velocity_rad_s", "magnetic_field"])
def test_a_stuck_axis_is_told(channel):
    values = getattr(SOUND, channel).copy()
    values[500:700, 2] = values[500, 2]
    told = [p for p in problems([replace(SOUND, **{channel: values})]) if p.kind == "stuck"]
    assert told[0].fatal
    assert "axis z" in told[0].text
    assert "5.00 s" in told[0].text or "5.01 s" in told[0].text


@pytest.mark.parametrize("width", [1, 3])
def test_clipped_peaks_are_told(width):
    fast = turning(12.0, rate_rad_s=4.0)
    one = fast.readings(gyro=fast.gyro + NOISE, force=fast.force + NOISE, field=fast.field + NOISE)
    rates = one.angular_velocity_rad_s.copy()
    limit = float(np.radians(125.0))
    peaks = np.flatnonzero(rates[:, 0] > limit)
    rates[:, 0] = np.minimum(rates[:, 0], limit - 0.01)
    for at in peaks[:: max(1, len(peaks) // 12)]:
        rates[at : at + width, 0] = limit
    told = [p for p in problems([replace(one, angular_velocity_rad_s=rates)]) if p.kind == "saturated"]
    assert "125 deg/s" in told[0].text
    assert not told[0].fatal
    assert [p for p in problems([one]) if p.kind == "saturated"] == []


def test_unequal_rates_are_told():
    half = ImuReadings(
        "b",
        SOUND.time_s[::2],
        SOUND.specific_force_mps2[::2],
        SOUND.angular_velocity_rad_s[::2],
        None,
        RATE_HZ / 2,
    )
    assert kinds(SOUND, half) == ["rate"]


def test_a_wrong_rate_and_times_that_fall_are_told():
    assert "rate" in kinds(replace(SOUND, rate_hz=2 * RATE_HZ))
    times = SOUND.time_s.copy()
    times[100] = times[98]
    assert kinds(replace(SOUND, time_s=times))[0] == "time"
    with pytest.raises(InvalidInput, match="do not increase"):
        refuse_fatal(problems([replace(SOUND, time_s=times)]))


def test_a_sensor_without_gyroscope_is_no_fault():
    one = replace(SOUND, angular_velocity_rad_s=np.full_like(SOUND.angular_velocity_rad_s, np.nan))
    assert problems([one]) == ()


def test_short_readings_are_judged_as_far_as_they_go():
    first = ImuReadings("a", [0.0, 0.01], [[0, 0, 1.0]] * 2, [[0, 0, 0.0]] * 2, None, RATE_HZ)
    assert kinds(first) == ["unit"]


@pytest.mark.slow
def test_real_recordings_are_sound(real_data):
    from mbkf.io.imu.files import read_imu

    body = read_imu(real_data / "imu_qmt_fullbody" / "full_body_example_data.mat")
    feet = read_imu(
        real_data / "imu_gaitmap_foot" / "imu_sample.csv",
        units={"acc": "m/s2", "gyr": "deg/s"},
        rate_hz=204.8,
    )
    assert [problem.text for problem in problems(feet) if problem.fatal] == []
    assert [problem.text for problem in problems(body) if problem.fatal] == []


@pytest.mark.parametrize(("swing_g", "fatal"), [(2.0, False), (0.5, True)])
def test_a_force_of_more_than_3_g_in_the_middle_is_a_runner_s_only_where_it_changes_much(swing_g, fatal):
    """By more than 40 % of its size, one standard deviation; otherwise its unit or scale is wrong."""
    size = 2.5 + swing_g * np.sin(2.0 * np.pi * 2.7 * SOUND.time_s)
    running = size[:, None] * SOUND.specific_force_mps2
    (problem,) = problems([replace(SOUND, specific_force_mps2=running)])
    assert (problem.kind, problem.fatal) == ("unit", fatal)
    assert "check its unit" in problem.text


def test_the_gyroscope_is_judged_while_it_turns_most():
    """In a rest of any length gravity stays where it is, whatever the gyroscope's sign."""
    rest = np.ones((round(18.0 * RATE_HZ), 1))
    noise = np.random.default_rng(1).normal(0.0, 0.01, (len(rest), 3))
    gyro = np.concatenate([-SOUND.angular_velocity_rad_s, noise])
    force = np.concatenate(
        [
            SOUND.specific_force_mps2,
            rest * MADE.force[-1] / np.linalg.norm(MADE.force[-1]) * GRAVITY_M_S2 + noise,
        ]
    )
    times = np.arange(len(gyro)) / RATE_HZ
    (problem,) = problems([ImuReadings("a", times, force, gyro, None, RATE_HZ)])
    assert problem.kind == "sign"
