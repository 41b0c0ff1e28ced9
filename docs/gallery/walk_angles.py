"""Angles of a walk beside Plug-in Gait.

A child's walk: hip, knee and ankle of the right leg with their 95 % intervals, read in Plug-in Gait's axes,
and the angles that Plug-in Gait stored in the file. The courses agree; the means differ by 1 to 2 degrees,
since the two place the body's axes differently.

Capture: biomechzoo_walk_turn
"""

import os
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

import mbkf

folder = Path(os.environ["MBKF_DATA"]) / "biomechzoo_walk_turn"
trial = mbkf.read_capture(folder / "HC032A_Straight_HC032A03.c3d")
subject = mbkf.scale(mbkf.read_capture(folder / "HC032A_Static_HC032A01.c3d"), mass_kg=60.3)
result = mbkf.reconstruct(trial, subject, settings=mbkf.ReconstructSettings(angles="pig"))
stored = {point.name: point.values for point in trial.derived}

figure = Figure(figsize=(8.0, 2.8), layout="constrained")
panels = {"hip_flexion_r": "RHipAngles", "knee_angle_r": "RKneeAngles", "ankle_angle_r": "RAnkleAngles"}
for axes, (name, theirs) in zip(figure.subplots(1, 3), panels.items(), strict=True):
    angle, half = np.degrees(result.angle(name)), 1.96 * np.degrees(result.angle_sd(name))
    axes.fill_between(result.times_s, angle - half, angle + half, color="C0", alpha=0.25, linewidth=0.0)
    axes.plot(result.times_s, angle, color="C0", label="mbkf, 95 %")
    axes.plot(result.times_s, stored[theirs][:, 0], "k--", linewidth=0.9, label="Plug-in Gait")
    axes.set(title=name, xlabel="time (s)")
    both = np.isfinite(stored[theirs][:, 0]) & result.tracked
    r = np.corrcoef(angle[both], stored[theirs][both, 0])[0, 1]
    print(f"{name}: r = {r:.3f}, mean difference {np.mean((angle - stored[theirs][:, 0])[both]):+.1f} deg")
    assert r > 0.95
figure.axes[0].set_ylabel("angle (deg)")
figure.axes[0].legend(frameon=False, fontsize=8)
figure.savefig("walk_angles.png", dpi=150)
