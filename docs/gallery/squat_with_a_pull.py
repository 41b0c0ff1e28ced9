"""A squat with a pull that no plate reads.

A squat on a flywheel device, which pulls the person down by a belt. The plates read the feet's load, not the
pull, so mbkf finds a force of more than half the body's weight that nothing explains, and refuses the loads
of those frames (grey). Angles remain valid.

Capture: flywheel_squat
"""

import os
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

import mbkf

folder = Path(os.environ["MBKF_DATA"]) / "flywheel_squat"
subject = mbkf.scale(mbkf.read_capture(folder / "S1_StandingRef.c3d"), mass_kg=81.3)
result = mbkf.reconstruct(mbkf.read_capture(folder / "S1_FlywheelSquat.c3d"), subject)

knee, half = np.degrees(result.angle("knee_angle_r")), 1.96 * np.degrees(result.angle_sd("knee_angle_r"))
figure = Figure(figsize=(8.0, 2.8), layout="constrained")
left, right = figure.subplots(1, 2)
left.fill_between(result.times_s, knee - half, knee + half, color="C0", alpha=0.25, linewidth=0.0)
left.plot(result.times_s, knee, color="C0")
left.set(title="right knee, 95 % interval", ylabel="flexion (deg)", xlabel="time (s)")
right.plot(result.times_s, result.foot_wrench[:, :, 2].sum(axis=1), color="C0", label="both feet")
right.plot(result.times_s, result.unexplained_force_n[:, 2], color="C3", label="unexplained")
right.axhline(81.3 * 9.81, color="k", linestyle="--", linewidth=0.9, label="body weight")
right.set(title="vertical force", ylabel="force (N)", xlabel="time (s)")
right.fill_between(
    result.times_s, 0, 1, where=~result.valid, color="0.9", transform=right.get_xaxis_transform()
)
right.legend(frameon=False, fontsize=8)
for load in result.unexplained:
    print(f"{np.linalg.norm(load.vector_n):.0f} N unexplained from {load.from_s:.2f} to {load.to_s:.2f} s")
print(f"loads are valid in {result.valid.mean():.0%} of the frames")
assert result.unexplained and not result.valid.all()
figure.savefig("squat_with_a_pull.png", dpi=150)
