"""Orientation of an inertial sensor beside cameras.

A board with one sensor is turned fast by hand, and cameras measure its orientation. Drawn is the error of
mbkf's Kalman filter and of Madgwick's in the first minute: about the vertical, where the magnetometer alone
helps, and of the inclination, which gravity corrects (Laidig et al., Data 2021, 6(7):72, section 4). The
Kalman filter states the 95 % interval of heading.

Capture: imu_broad
"""

import os
from dataclasses import fields, replace
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from scipy.spatial.transform import Rotation

import mbkf

file = Path(os.environ["MBKF_DATA"]) / "imu_broad" / "08_undisturbed_fast_rotation_with_breaks_A.mat"
(sensor,) = mbkf.read_imu(file)
count = int(60.0 * sensor.rate_hz)
of_samples = [field.name for field in fields(sensor) if isinstance(getattr(sensor, field.name), np.ndarray)]
sensor = replace(sensor, **{name: getattr(sensor, name)[:count] for name in of_samples})
found = mbkf.orient([sensor], frame="ENU", compare="madgwick")

figure = Figure(figsize=(8.0, 2.8), layout="constrained")
heading, inclination = figure.subplots(1, 2)
half = 1.96 * np.degrees(found.courses[0].sd_rad[:, 2])
heading.fill_between(sensor.time_s, -half, half, color="C0", alpha=0.25, linewidth=0.0)
seen = np.isfinite(sensor.orientation).all(axis=1)
cameras = Rotation.from_quat(sensor.orientation[seen])
for course in (*found.courses, *found.compared):
    x, y, z, w = (Rotation.from_quat(course.quaternion[seen]) * cameras.inv()).as_quat(canonical=True).T
    errors = np.degrees([2.0 * np.arctan2(z, w), 2.0 * np.arctan2(np.hypot(x, y), np.hypot(z, w))])
    rms = np.sqrt(np.mean(errors[:, sensor.moving[seen]] ** 2, axis=1))
    print(f"{course.method}: {rms[0]:.2f} deg RMS of heading and {rms[1]:.2f} of inclination in movement")
    for axes, error, size in zip((heading, inclination), errors, rms, strict=True):
        axes.plot(sensor.time_s[seen], error, linewidth=0.8, label=f"{course.method}: {size:.1f} deg RMS")
    assert rms[1] < 3.0
heading.set(title="heading", xlabel="time (s)", ylabel="error (deg)", ylim=(-10.0, 10.0))
inclination.set(title="inclination", xlabel="time (s)", ylim=(0.0, None))
for axes in (heading, inclination):
    axes.legend(frameon=False, fontsize=8)
figure.savefig("inertial_orientation.png", dpi=150)
