"""Strides of a run.

The first two and a half seconds of a run at 3.5 m/s on a treadmill whose belt is one force plate. Strides are
cut where the right foot strikes, and drawn over each other: flexion and torque of the right knee, and the
vertical force under the right foot.

Capture: fukuchi_run
"""

import os
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

import mbkf

folder = Path(os.environ["MBKF_DATA"]) / "fukuchi_run"
run = mbkf.read_capture(folder / "RBDS001runT35.c3d")
count = int(2.5 * run.markers.rate_hz)
run = replace(run, markers=replace(run.markers, positions_m=run.markers.positions_m[:count]))
subject = mbkf.scale(mbkf.read_capture(folder / "RBDS001static.c3d"), mass_kg=60.3)
result = mbkf.reconstruct(run, subject)

loaded = result.foot_wrench[:, 0, 2] > 50.0
strikes = np.flatnonzero(loaded[1:] & ~loaded[:-1]) + 1
percent = np.linspace(0.0, 100.0, 101)
courses = {
    "knee flexion (deg)": np.degrees(result.angle("knee_angle_r")),
    "knee torque (N m)": result.torque("knee_angle_r"),
    "vertical force (N)": result.foot_wrench[:, 0, 2],
}
figure = Figure(figsize=(8.0, 2.8), layout="constrained")
for axes, (label, course) in zip(figure.subplots(1, 3), courses.items(), strict=True):
    for first, last in pairwise(strikes):
        axes.plot(percent, np.interp(first + percent / 100 * (last - first), np.arange(count), course))
    axes.set(title=label, xlabel="stride (%)")
    print(f"{label}: {course.min():z.0f} to {course.max():z.0f}")
seconds = np.diff(strikes) / run.markers.rate_hz
print(f"{len(seconds)} strides of {seconds.mean():.2f} ± {seconds.std():.2f} s")
assert len(seconds) >= 2 and seconds.std() < 0.03
figure.savefig("run.png", dpi=150)
