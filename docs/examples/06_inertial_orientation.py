"""Orientation of an inertial sensor from a CSV file: an error-state Kalman filter against Madgwick's filter.

The file is made here: a sensor lies still, is turned by 90° about its own x axis, and lies still again. Its gyroscope
has a bias of 0.5 deg/s and noise.
"""

import numpy as np

import mbkf

rng = np.random.default_rng(0)
rate_hz = 100.0
time_s = np.arange(0.0, 8.0, 1.0 / rate_hz)
turned_rad = 0.5 * np.pi * np.clip((time_s - 3.0) / 2.0, 0.0, 1.0)
gyro_deg_s = np.zeros((len(time_s), 3))
gyro_deg_s[:, 0] = np.degrees(np.gradient(turned_rad, time_s))
gyro_deg_s += 0.5 + 0.1 * rng.standard_normal(gyro_deg_s.shape)
up = np.column_stack([np.zeros_like(turned_rad), np.sin(turned_rad), np.cos(turned_rad)])
acceleration_g = up + 0.005 * rng.standard_normal(up.shape)

names = [f"hand_{kind}_{axis} [{unit}]" for kind, unit in (("acc", "g"), ("gyr", "deg/s")) for axis in "xyz"]
table = np.column_stack([time_s, acceleration_g, gyro_deg_s])
np.savetxt("hand.csv", table, delimiter=",", header=",".join(["time [s]", *names]), comments="")

readings = mbkf.read_imu("hand.csv")  # units are read from the column names
found = mbkf.orient(readings, frame="ENU", compare="madgwick")
for course in (*found.courses, *found.compared):
    x, y, z, w = course.quaternion[-1]
    up_in_sensor = np.array([2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)])
    roll_deg = np.degrees(np.arctan2(up_in_sensor[1], up_in_sensor[2]))
    print(f"{course.method:9} roll at the end {roll_deg:.2f} deg (true: 90)")
    assert abs(roll_deg - 90.0) < 3.0
