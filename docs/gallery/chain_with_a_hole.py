"""A chain with a hole.

A walk without a marker on the pelvis, of which every sixth frame is taken. Thighs and trunk are seen, the
joints between them are not: their intervals are wide. The knee's interval is narrow, since thigh and shank
carry markers.

Capture: french_walk_no_pelvis
"""

import os
from dataclasses import replace
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

import mbkf

walk = mbkf.read_capture(Path(os.environ["MBKF_DATA"]) / "french_walk_no_pelvis" / "marche281.c3d")
thinned = replace(walk.markers, positions_m=walk.markers.positions_m[::6], rate_hz=walk.markers.rate_hz / 6)
walk = replace(walk, markers=thinned)
subject = mbkf.scale(trials=[walk], mass_kg=69.0, height_m=1.74)
result = mbkf.reconstruct(walk, subject)

figure = Figure(figsize=(8.0, 2.8), layout="constrained")
width = {}
names = "knee_angle_r", "hip_flexion_r", "lumbar_extension"
for axes, name in zip(figure.subplots(1, 3), names, strict=True):
    angle, half = np.degrees(result.angle(name)), 1.96 * np.degrees(result.angle_sd(name))
    axes.fill_between(result.times_s, angle - half, angle + half, color="C0", alpha=0.25, linewidth=0.0)
    axes.plot(result.times_s, angle, color="C0")
    axes.set(title=name, xlabel="time (s)", ylim=angle.mean() + np.array([-60.0, 60.0]))
    width[name] = np.nanmedian(half)
    print(f"{name}: ± {width[name]:.1f} deg")
figure.axes[0].set_ylabel("angle, 95 % interval (deg)")
assert width["hip_flexion_r"] > 1.5 * width["knee_angle_r"]
figure.savefig("chain_with_a_hole.png", dpi=150)
