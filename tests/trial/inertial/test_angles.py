"""Joint angles from sensors alone, against the motion they were made from."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from mbkf.errors import InvalidInput
from mbkf.imu.orientation import OrientSettings
from mbkf.imu.placement import typical_mounts
from mbkf.imu.virtual import virtual_imus
from mbkf.model.clinical import ClinicalAngles
from mbkf.model.human import HumanModel
from mbkf.trial.inertial.angles import AnglesSettings, imu_angles

pytestmark = pytest.mark.slow

MODEL = HumanModel.scaled()
RATE = 50.0
SAGITTAL = (
    "hip_flexion_r",
    "knee_angle_r",
    "ankle_angle_r",
    "hip_flexion_l",
    "knee_angle_l",
    "ankle_angle_l",
)


@cache
def marching(turn=0.0, careless=True):
    """Two seconds of standing, then marching on the spot; hinges about y, so that q, v and a are exact."""
    t = np.arange(300) / RATE
    since = np.maximum(t - 2.0, 0.0)
    ramp = np.clip(since, 0.0, 1.0) ** 3 * (10 - 15 * np.clip(since, 0, 1) + 6 * np.clip(since, 0, 1) ** 2)
    angles = np.zeros((len(t), MODEL.nv))
    for side, phase in (("right", 0.0), ("left", np.pi)):
        lift = ramp * 0.5 * (1.0 - np.cos(2 * np.pi * 0.8 * since + phase * (since > 0)))
        for part, size in (("thigh", -0.7), ("shank", 1.0), ("foot", -0.3)):
            angles[:, MODEL.joint(f"{side}_{part}").v.start + 1] = size * lift
    v = np.gradient(angles, 1 / RATE, axis=0)
    a = np.gradient(v, 1 / RATE, axis=0)
    start = MODEL.neutral()
    start[3:7] = [0.0, 0.0, np.sin(0.5 * turn), np.cos(0.5 * turn)]
    q = np.array([MODEL.integrate(start, one) for one in angles])
    readings = virtual_imus(MODEL, t, q, v, a, typical_mounts(MODEL, seed=0 if careless else None), seed=0)
    clinical = ClinicalAngles(MODEL)
    truth = np.degrees(clinical.angles(q))
    return readings, {name: truth[:, clinical.names.index(name)] for name in SAGITTAL}


def worst(found, truth):
    errors = {n: np.degrees(found.angles[:, found.names.index(n)]) - truth[n] for n in SAGITTAL}
    return max(float(np.sqrt((error**2).mean())) for error in errors.values())


@pytest.mark.parametrize(("method", "turn"), [("smooth", 0.0), ("ekf", 2.0), ("madgwick", 0.0)])
def test_angles_are_found_wherever_the_person_faces(method, turn):
    readings, truth = marching(turn)
    found = imu_angles(readings, MODEL, standing=(0.0, 1.8), settings=AnglesSettings(OrientSettings(method)))
    assert worst(found, truth) < (6.0 if method == "madgwick" else 3.0)


def test_without_magnetometers_sensors_have_to_be_strapped_on_as_usual():
    readings, truth = marching(0.7, careless=False)
    blind = [replace(one, magnetic_field=None) for one in readings]
    assert worst(imu_angles(blind, MODEL), truth) < 3.0


def test_standing_may_be_recorded_apart_and_facing_elsewhere():
    readings, truth = marching(0.0)
    other, _ = marching(2.0)
    part = slice(0, 75)
    standing = [
        replace(
            one, time_s=one.time_s[part], specific_force_mps2=one.specific_force_mps2[part],
            angular_velocity_rad_s=one.angular_velocity_rad_s[part], magnetic_field=one.magnetic_field[part],
            orientation=one.orientation[part],
        )
        for one in other
    ]  # fmt: skip
    assert worst(imu_angles(readings, MODEL, standing=standing), truth) < 3.0
    with pytest.raises(InvalidInput, match="lacks sensor"):
        imu_angles(readings, MODEL, standing=standing[1:])


def test_only_what_sensors_determine_is_told():
    readings, _ = marching()
    legs = [one for one in readings if one.name in ("pelvis", "right_thigh", "right_shank")]
    found = imu_angles(legs, MODEL)
    assert {"hip_flexion_r", "knee_angle_r", "pelvis_tilt"} <= set(found.names)
    assert not {"ankle_angle_r", "hip_flexion_l", "lumbar_extension"} & set(found.names)
    assert [mount.segment for mount in found.mounts] == ["pelvis", "right_thigh", "right_shank"]


def test_the_posture_while_standing_is_taken_into_account():
    readings, truth = marching()
    bent = MODEL.neutral()
    bent[MODEL.joint("right_shank").q] = [0.0, np.sin(0.1), 0.0, np.cos(0.1)]
    found = imu_angles(readings, MODEL, posture=bent)
    index = found.names.index("knee_angle_r")
    difference = np.degrees(found.angles[:, index]) - truth["knee_angle_r"]
    assert difference[:75].mean() == pytest.approx(np.degrees(0.2), abs=1.5)


def test_what_cannot_work_is_refused():
    readings, _ = marching()
    with pytest.raises(InvalidInput, match="pelvis"):
        imu_angles([one for one in readings if one.name != "pelvis"], MODEL)
    sway = 0.4 * np.sin(np.arange(300) / 4.0)[:, None]
    moving = [replace(one, angular_velocity_rad_s=one.angular_velocity_rad_s + sway) for one in readings]
    with pytest.raises(InvalidInput, match="stands still"):
        imu_angles(moving, MODEL)
    with pytest.raises(InvalidInput, match="readings are missing"):
        imu_angles(readings, MODEL, standing=(50.0, 60.0))
    with pytest.raises(InvalidInput, match="two sensors sit"):
        imu_angles([*readings, replace(readings[0], name="hip")], MODEL)
    with pytest.raises(InvalidInput, match="brings no orientations"):
        bare = [replace(one, orientation=None) for one in readings]
        imu_angles(bare, MODEL, settings=AnglesSettings(from_file=True))


def test_orientations_of_the_file_may_be_used():
    readings, truth = marching(1.0)
    found = imu_angles(readings, MODEL, standing=(0.0, 1.8), settings=AnglesSettings(from_file=True))
    assert worst(found, truth) < 1.0


@pytest.mark.parametrize("name", ["pelvis", "left_shank", "right_foot"])
def test_a_bad_magnetometer_is_named_and_left_out(name):
    readings, truth = marching()
    sound = imu_angles(readings, MODEL, standing=(0.0, 1.8))
    bad = [
        replace(one, magnetic_field=0.3 * one.magnetic_field[:, [2, 0, 1]]) if one.name == name else one
        for one in readings
    ]
    found = imu_angles(bad, MODEL, standing=(0.0, 1.8))
    assert next(text for text in found.warnings if "magnetometer of" in text).startswith(
        f"magnetometer of {name}"
    )
    assert len(found.warnings) == len(sound.warnings) + 1
    assert worst(found, truth) < 3.0


def test_what_is_doubtful_is_told():
    readings, _ = marching(0.7, careless=False)
    assert imu_angles(readings, MODEL).warnings == ()
    blind = [replace(one, magnetic_field=None) for one in readings]
    assert "no heading" in imu_angles(blind, MODEL).warnings[0]
    turned = np.array([1.0, -1.0, -1.0])
    inside_out = [
        replace(
            one,
            specific_force_mps2=one.specific_force_mps2 * turned,
            angular_velocity_rad_s=one.angular_velocity_rad_s * turned,
        )
        if "right" in one.name
        else one
        for one in blind
    ]
    told = imu_angles(inside_out, MODEL).warnings
    assert any("right_shank" in text and "beyond its range" in text for text in told)
    assert not any("left_shank" in text for text in told)


def test_a_real_walk_with_the_makers_orientations_bends_knees_as_people_do(real_data):
    from mbkf.io.imu.files import read_imu

    sensors = read_imu(real_data / "imu_opensense_walk")
    found = imu_angles(sensors, MODEL, standing=(0.0, 0.5), settings=AnglesSettings(from_file=True))
    assert found.warnings == ()
    for name in ("knee_angle_r", "knee_angle_l"):
        knee = np.degrees(found.angles[:, found.names.index(name)])
        assert -15.0 < knee.min() < 5.0
        assert 50.0 < knee.max() < 80.0
