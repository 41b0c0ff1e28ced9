"""Motion from sensors alone, without magnetometers: against the truth, with its spreads; what is told of sensors."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.errors import InvalidInput
from mbkf.io.imu.readings import between
from mbkf.model.clinical import ClinicalAngles
from mbkf.trial.inertial import misfit, motion
from mbkf.trial.inertial.motion import InertialMotionSettings, inertial_motion
from mbkf.trial.inertial.mounted_reversed import SensorPlacement, mounted_reversed
from tests.worn import exchanged, worn

FLEXION = [f"{joint}_{side}" for joint in ("hip_flexion", "knee_angle", "ankle_angle") for side in "rl"]


@pytest.fixture(scope="module", autouse=True)
def worn_as_named():
    """Other ways of wearing the sensors are looked at by one test only."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(motion, "mounted_reversed", lambda *_: SensorPlacement())
        yield


@pytest.fixture(scope="module")
def walk():
    return worn(seconds=3.0)


@pytest.fixture(scope="module")
def found(walk):
    settings = InertialMotionSettings(smooth=False)
    return inertial_motion(
        walk.moving, walk.subject, standing=walk.standing, posture=walk.posture, settings=settings
    )


def errors(walk, result):
    """Degrees, from the second second on, of the flexions and their spreads."""
    clinical = ClinicalAngles(walk.model)
    truth, own = clinical.angles(walk.motion.q), [result.coordinate_names.index(name) for name in FLEXION]
    chosen = [clinical.names.index(name) for name in FLEXION]
    apart = clinical.angles(result.q)[:, chosen] - truth[:, chosen]
    return np.degrees(apart)[100:], np.degrees(result.angles_sd[:, own])[100:]


def test_flexions_are_within_the_spreads_that_are_told(walk, found):
    apart, sd = errors(walk, found.result)
    assert np.sqrt((apart**2).mean(axis=0)).max() < 4.0
    assert 0.2 < np.sqrt(np.mean((apart / sd) ** 2)) < 1.4


def test_the_pelvis_walks_as_far_as_it_did(walk, found):
    paths = [q[:, :2] - q[0, :2] for q in (found.result.q, walk.motion.q)]
    told, true = (float(np.linalg.norm(path[-1])) for path in paths)
    assert told == pytest.approx(true, rel=0.03)


def test_the_ground_bears_the_body(walk, found):
    weight = 9.80665 * walk.model.mass_kg
    vertical, true = (w[100:, :, 2].sum(axis=1) for w in (found.result.foot_wrench, walk.motion.foot_wrench))
    assert np.sqrt(np.mean((vertical - true) ** 2)) < 0.05 * weight


def test_magnetometers_change_nothing_and_a_bad_one_is_named(walk, found):
    assert found.disturbed_fields == ()
    bad = list(walk.moving)
    bad[3] = replace(bad[3], magnetic_field=0.3 * bad[3].magnetic_field)
    settings = InertialMotionSettings(smooth=False)
    other = inertial_motion(
        bad, walk.subject, standing=walk.standing, posture=walk.posture, settings=settings
    )
    assert [one.sensor for one in other.disturbed_fields] == [bad[3].name]
    np.testing.assert_array_equal(other.result.q, found.result.q)
    assert any(bad[3].name in text for text in other.result.warnings)


def test_exchanged_sides_are_told(walk, monkeypatch):
    """Less than a second of each way of wearing the sensors tells them apart here."""
    monkeypatch.setattr(motion, "mounted_reversed", mounted_reversed)
    monkeypatch.setattr(misfit, "LOOKED_AT_S", 0.8)
    pair = ("right_shank", "left_shank")
    moving, standing = (exchanged(one, *pair) for one in (walk.moving, walk.standing))
    moving = [between(one, 0.0, 1.5) for one in moving]
    settings = InertialMotionSettings(smooth=False)
    found = inertial_motion(moving, walk.subject, standing=standing, posture=walk.posture, settings=settings)
    assert found.worn.exchange is not None and set(found.worn.exchange.segments) == set(pair)
    assert not found.worn.turned
    assert any("exchanged" in text for text in found.result.warnings)


def strapped_on_reversed(one, about):
    """A sensor that is turned by 180° about the direction of its force (3,) at rest."""
    turn = 2.0 * np.outer(about, about) / (about @ about) - np.eye(3)
    return replace(
        one,
        specific_force_mps2=one.specific_force_mps2 @ turn,
        angular_velocity_rad_s=one.angular_velocity_rad_s @ turn,
    )


def test_a_run_begun_anew_is_that_of_sensors_known_to_be_reversed(walk, monkeypatch):
    monkeypatch.setattr(misfit, "LOOKED_AT_S", 0.1)
    reversed_one, planned = frozenset({"pelvis"}), motion._planned
    moving, still = [between(one, 0.0, 1.5) for one in walk.moving], list(walk.standing)
    k = [one.name for one in moving].index("pelvis")
    about = still[k].specific_force_mps2.mean(axis=0)
    still[k], moving[k] = (strapped_on_reversed(one, about) for one in (still[k], moving[k]))

    def run():
        settings = InertialMotionSettings(smooth=False)
        return inertial_motion(moving, walk.subject, standing=still, posture=walk.posture, settings=settings)

    with monkeypatch.context() as known:
        known.setattr(motion, "_planned", lambda *given: replace(planned(*given), turned=reversed_one))
        expected = run()
    monkeypatch.setattr(motion, "mounted_reversed", lambda *_: SensorPlacement(reversed_one))
    found = run()
    np.testing.assert_array_equal(found.result.q, expected.result.q)
    np.testing.assert_array_equal(found.result.angles_sd, expected.result.angles_sd)
    for one, other in zip(found.mounts, expected.mounts, strict=True):
        np.testing.assert_array_equal(one.rotation, other.rotation)
    assert found.worn.turned == reversed_one
    assert any("the sensors of pelvis are strapped on" in text for text in found.result.warnings)


def test_standing_in_the_recording_is_where_the_motion_begins():
    one = worn("squat", 1.2)
    joined = tuple(
        replace(
            still,
            time_s=np.concatenate([still.time_s, still.time_s[-1] + 0.01 + moving.time_s - moving.time_s[0]]),
            specific_force_mps2=np.vstack([still.specific_force_mps2, moving.specific_force_mps2]),
            angular_velocity_rad_s=np.vstack([still.angular_velocity_rad_s, moving.angular_velocity_rad_s]),
            magnetic_field=None,
            orientation=None,
        )
        for still, moving in zip(one.standing, one.moving, strict=True)
    )
    settings = InertialMotionSettings(smooth=False)
    found = inertial_motion(joined, one.subject, standing=(2.0, 2.8), posture=one.posture, settings=settings)
    assert found.result.times_s[0] == pytest.approx(2.0)
    np.testing.assert_allclose(
        found.gyro_bias_rad_s[0], joined[0].angular_velocity_rad_s[:300].mean(axis=0), atol=2e-3
    )


def test_three_sensors_on_a_leg_tell_knee_and_ankle_and_claim_nothing_else(walk):
    one, leg = walk, ("right_thigh", "right_shank", "right_foot")
    standing, moving = ([r for r in readings if r.name in leg] for readings in (one.standing, one.moving))
    settings = InertialMotionSettings(smooth=False)
    result = inertial_motion(
        moving, one.subject, standing=standing, posture=one.posture, settings=settings
    ).result
    clinical = ClinicalAngles(one.model)
    truth, own = clinical.angles(one.motion.q), clinical.angles(result.q)
    for name in ("knee_angle_r", "ankle_angle_r"):
        k = clinical.names.index(name)
        assert np.degrees(np.sqrt(np.mean((own[100:, k] - truth[100:, k]) ** 2))) < 5.0
    sd = np.degrees(result.angles_sd[:, result.coordinate_names.index("hip_flexion_r")])
    assert sd.min() > 30.0 and not result.valid.any()
    assert np.isnan(result.moments).all()
    assert "right_thigh_y" in next(text for text in result.warnings if "move no sensor" in text)


def test_what_is_missing_or_twice_is_told(walk):
    with pytest.raises(InvalidInput, match="lacks sensor"):
        inertial_motion(walk.moving, walk.subject, standing=walk.standing[:3])
    twice = [*walk.moving, replace(walk.moving[0], name="hips")]
    with pytest.raises(InvalidInput, match="two sensors sit on pelvis"):
        inertial_motion(twice, walk.subject, standing=walk.standing)
