"""Ground reactions without plates.

A walk over force plates, reconstructed without them: the vertical force under each foot follows from the
motion alone. The plates show the error of the estimate, which its 95 % interval holds. The left foot's first
and last steps miss the plates. While both feet stand, the motion says little about how they share the load,
and the interval is wider.

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
withheld = mbkf.ReconstructSettings(without_plates=tuple(plate.name for plate in walk.plates))
result = mbkf.reconstruct(walk, subject, settings=withheld)
assert result.foot_wrench_sd is not None

figure = Figure(figsize=(8.0, 2.8), layout="constrained")
feet = {"r": "right foot", "l": "left foot"}
for foot, (axes, plate) in enumerate(zip(figure.subplots(1, 2, sharey=True), walk.plates, strict=True)):
    force, half = result.foot_wrench[:, foot, 2], 1.96 * result.foot_wrench_sd[:, foot, 2]
    axes.fill_between(result.times_s, force - half, force + half, color="C0", alpha=0.25, linewidth=0.0)
    axes.plot(result.times_s, force, color="C0", label="estimate, 95 %")
    axes.plot(plate.times_s, plate.force_n[:, 2], "k--", linewidth=0.9, label="plate")
    axes.set(title=feet[plate.name], xlabel="time (s)", xlim=result.times_s[[0, -1]])
    measured = np.interp(result.times_s, plate.times_s, plate.force_n[:, 2])
    stands = measured > 20.0
    error = (force - measured)[stands]
    inside, rms = np.mean(np.abs(error) <= half[stands]), np.sqrt(np.mean(error**2))
    print(f"{feet[plate.name]}: {rms:.0f} N RMS in stance, {inside:.0%} in the interval")
    assert np.corrcoef(force[stands], measured[stands])[0, 1] > 0.8
figure.axes[0].set_ylabel("vertical force (N)")
figure.axes[0].legend(frameon=False, fontsize=8)
figure.savefig("ground_reaction.png", dpi=150)
