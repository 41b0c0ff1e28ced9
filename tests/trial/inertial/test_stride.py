"""From readings to strides."""

import json
from dataclasses import replace

import numpy as np
import pytest

from benchmarks.inertial.foot_walks import foot_walk
from benchmarks.inertial.stride import SMOOTHER_MM
from benchmarks.inertial.stride_measured import clipped, compare_one, reference_strides
from mbkf.errors import InvalidInput, UnknownName
from mbkf.imu.foot_filter import FootFilterSettings
from mbkf.imu.key_points import KeyPointSettings
from mbkf.imu.zero_velocity import StillnessSettings
from mbkf.io.imu.table import read_imu_csv
from mbkf.trial.inertial.stride import METHODS, StrideSettings, measure_strides, stride_summary

pytestmark = pytest.mark.slow

STEP_S = 0.55


def two_feet(**options):
    """The right foot steps half a cycle after the left, its sensor mounted and headed otherwise."""
    noise = {"force_noise_m_s2": 0.05, "rate_noise_rad_s": 0.01} | options
    left = foot_walk((1.2, 1.3, 1.1), **noise)
    right = foot_walk(
        (1.25, 1.2, 1.15),
        name="right_foot",
        wait_s=STEP_S,
        heading_rad=0.8,
        mounting_rad=(0.1, 0.4, 2.5),
        **(noise | {"seed": 1}),
    )
    return left, right


@pytest.fixture(scope="module")
def both():
    left, right = two_feet()
    return left, right, measure_strides([left.readings, right.readings])


def test_lengths_and_speeds_are_those_of_the_walk(both):
    for walk, foot in zip(both[:2], both[2].feet, strict=True):
        assert [s.length_m for s in foot.strides] == pytest.approx(walk.lengths_m, abs=0.02)
        assert [s.duration_s for s in foot.strides] == pytest.approx([1.1] * 3, abs=0.1)
        assert all(0.0 < s.length_sd_m < 0.2 for s in foot.strides)
        assert max(abs(s.turn_rad) for s in foot.strides) < 0.05


def test_both_feet_walk_the_same_way(both):
    for foot in both[2].feet:
        way = foot.position_m[-1] - foot.position_m[0]
        assert way == pytest.approx([3.6, 0.0, 0.0], abs=0.06)


def test_rests_and_velocity_go_together(both):
    for foot in both[2].feet:
        speed = np.linalg.norm(foot.velocity_m_s, axis=1)
        assert speed[foot.still].max() < 0.2
        assert speed.max() > 2.0


def test_what_both_feet_show_together(both):
    summary = stride_summary(both[2])["both_feet"]
    assert summary["step_time_s_median"] == pytest.approx(STEP_S, abs=0.05)
    assert summary["cadence_steps_per_min"] == pytest.approx(60.0 / STEP_S, rel=0.1)
    assert summary["steps"] == 5
    assert abs(summary["length_asymmetry"]) < 0.05


@pytest.mark.parametrize("method", METHODS)
def test_every_method_measures_a_foot(method):
    walk = foot_walk((1.2,), rate_hz=50.0, mounting_rad=(0.0, 0.0, 0.0))
    settings = StrideSettings(method, key_points=KeyPointSettings(window=5, by_sample=True))
    measured = measure_strides([walk.readings], settings)
    (foot,) = measured.feet
    assert sum(s.length_m for s in foot.strides) == pytest.approx(1.2, abs=0.3)
    summary = stride_summary(measured)
    assert summary["method"] == method
    assert "both_feet" not in summary
    json.dumps(summary, allow_nan=False)


def test_the_summary_tells_of_a_capture_without_strides():
    measured = measure_strides([foot_walk((), rate_noise_rad_s=0.01, force_noise_m_s2=0.05).readings])
    summary = stride_summary(measured)
    assert summary["feet"]["left_foot"]["strides"] == 0
    assert summary["feet"]["left_foot"]["length_m_mean"] is None
    assert any("no stride" in text for text in summary["warnings"])


def test_a_stance_that_shakes_is_found_or_told_to_be_missed():
    one = foot_walk((1.2,) * 5, force_noise_m_s2=0.05, rate_noise_rad_s=0.01).readings
    middle = one.time_s.searchsorted(1.5 + 1.1 + 0.9)
    shaken = one.angular_velocity_rad_s.copy()
    shaken[middle - 22 : middle + 22] += np.random.default_rng(2).normal(size=(44, 3))
    measured = measure_strides([replace(one, angular_velocity_rad_s=shaken)])
    strides = measured.feet[0].strides
    accepted = [stride.length_m for stride in strides if not stride.doubt]
    assert accepted == pytest.approx([1.2] * len(accepted), abs=0.05)
    assert len(accepted) == 5 or any("a stance was missed" in stride.doubt for stride in strides)


def test_impossible_strides_are_refused_with_their_reason_and_are_no_part_of_means(both, monkeypatch):
    from mbkf.imu import stride_doubts

    monkeypatch.setattr(stride_doubts, "LONGEST_M", 1.25)
    measured = measure_strides([both[0].readings])
    summary = stride_summary(measured)["feet"]["left_foot"]
    refused = [stride for stride in measured.feet[0].strides if stride.doubt]
    assert 0 < len(refused) == summary["strides_refused"] < len(measured.feet[0].strides)
    assert summary["length_m_mean"] < 1.26
    assert any("longer than any person" in text for text in stride_summary(measured)["warnings"])
    monkeypatch.setattr(stride_doubts, "LONGEST_M", 0.5)
    with pytest.raises(InvalidInput, match="no stride can be"):
        measure_strides([both[0].readings])


def test_unusable_readings_are_refused_with_the_likely_fix():
    one = foot_walk(force_noise_m_s2=0.05, rate_noise_rad_s=0.01).readings
    nothing = np.full_like(one.angular_velocity_rad_s, np.nan)
    gap = one.specific_force_mps2.copy()
    gap[100:105, 1] = np.nan
    shaking = np.random.default_rng(1).normal(size=gap.shape)
    jump = one.time_s + np.where(one.time_s > 2.0, 0.5, 0.0)
    bad = {
        "too short for a stride": replace(
            one,
            time_s=one.time_s[:50],
            specific_force_mps2=one.specific_force_mps2[:50],
            angular_velocity_rad_s=one.angular_velocity_rad_s[:50],
        ),
        "no gyroscope": replace(one, angular_velocity_rad_s=nothing),
        "5 samples are missing, the first at 1.000 s": replace(one, specific_force_mps2=gap),
        "times jump at 2.000 s": replace(one, time_s=jump),
        "acc=g": replace(one, specific_force_mps2=one.specific_force_mps2 / 9.81),
    }
    for text, readings in bad.items():
        with pytest.raises(InvalidInput, match=text):
            measure_strides([readings])
    never = StrideSettings(stillness=StillnessSettings(rolling_threshold=1e-6))
    with pytest.raises(InvalidInput, match="never stands still"):
        measure_strides([replace(one, specific_force_mps2=one.specific_force_mps2 + 3.0 * shaking)], never)
    with pytest.raises(InvalidInput, match="at least one sensor"):
        measure_strides([])
    with pytest.raises(UnknownName, match="smoother"):
        StrideSettings("smooth")


def test_progress_is_told_per_foot(both):
    told = []
    measure_strides([walk.readings for walk in both[:2]], progress=lambda *words: told.append(words[1:]))
    assert told == [(0, 2), (1, 2), (2, 2)]


def test_measured_strides_and_level_ground(real_data):
    """The cameras' strides within the bound of the table, also on ground that is known to be level."""
    folder = real_data / "imu_gaitmap_foot"
    readings = read_imu_csv(folder / "imu_sample.csv", units={"acc": "m/s2", "gyr": "deg/s"}, rate_hz=204.8)
    settings = StrideSettings(kalman=FootFilterSettings(level_m=0.02))
    found = compare_one("level", settings, readings, reference_strides(folder))
    assert found.found == len(found.reference_m) == 57
    assert found.rmse_mm < SMOOTHER_MM
    # Far below what cameras and sensors can agree on would be a leak of the reference.
    assert found.rmse_mm > 10.0


def test_strides_of_a_gyroscope_that_clips_are_found_and_their_spreads_hold():
    """A foot that turns at up to 4.9 rad/s, read by a gyroscope that ends at 2.5 rad/s."""
    walk = foot_walk((1.2, 1.3, 1.1, 1.2, 1.3))
    (sound,) = measure_strides([walk.readings]).feet
    (cut,) = measure_strides([clipped(walk.readings, 2.5)]).feet
    lengths, spreads = np.array([(one.length_m, one.length_sd_m) for one in cut.strides]).T
    assert (np.abs(lengths - walk.lengths_m) < 2.0 * spreads).all()
    assert spreads.min() > 1.2 * max(one.length_sd_m for one in sound.strides)
