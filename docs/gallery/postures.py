"""Postures of a walk in three dimensions.

Every fiftieth frame of a walk: lines join the joint centres of the body, points are the measured markers, and
red lines the ground reactions from their centres of pressure, one metre for 1000 N.

Capture: rajagopal_walk_run
"""

import os
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

import mbkf

folder = Path(os.environ["MBKF_DATA"]) / "rajagopal_walk_run"
walk = mbkf.read_capture(folder / "motion_capture_walk.trc", forces=folder / "grf_walk.mot")
subject = mbkf.scale(mbkf.read_capture(folder / "static_walk_1.trc"), mass_kg=85.07)
result = mbkf.reconstruct(walk, subject)
body = mbkf.HumanModel.of(subject)

figure = Figure(figsize=(8.0, 4.0))
axes = figure.add_axes((0.0, -0.5, 1.0, 2.0), projection="3d", computed_zorder=False)
for frame in range(20, result.frames, 50):
    _, centres = body.placements(result.q[frame])
    for joint in range(2, len(centres)):
        axes.plot(*centres[[body.pin_model.parents[joint], joint]].T, color="C0")
    axes.scatter(*result.measured_m[frame].T, s=3, color="0.4")
    for wrench, pressed in zip(result.foot_wrench[frame], result.foot_cop_m[frame], strict=True):
        if wrench[2] > 20.0:
            axes.plot(*np.array([pressed, pressed + wrench[:3] / 1000.0]).T, color="C3")
axes.set(zlabel="z (m)", yticks=[])
axes.set_xlabel("x (m)", labelpad=12.0)
axes.set_aspect("equal")
axes.set_box_aspect(np.ptp([axes.get_xlim(), axes.get_ylim(), axes.get_zlim()], axis=1), zoom=0.8)
axes.view_init(elev=12, azim=-75)
print(f"{body.pin_model.njoints - 1} joints, {len(result.marker_names)} markers, {result.frames} frames")
height = result.measured_m[:, :, 2]
assert 1.2 < np.nanmax(height) < 1.83
figure.savefig("postures.png", dpi=150)
