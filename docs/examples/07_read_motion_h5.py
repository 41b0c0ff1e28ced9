"""Read motion.h5 with h5py alone, then with xarray, which knows the labels of its axes."""

import json
from subprocess import run
from sys import executable

import h5py
import numpy as np
import xarray

command = [executable, "-m", "mbkf"]
run(
    [*command, "synth", "--motion", "squat", "--seconds", "1", "--out", "lab"],
    check=True,
    capture_output=True,
)
words = ["reconstruct", "lab/trial.c3d", "--subject", "lab/subject.toml", "--out", "result"]
run([*command, *words], check=True, capture_output=True)

with h5py.File("result/motion.h5") as file:
    print(
        file.attrs["trial"], "|", file.attrs["filter"], "|", file.attrs["rate_hz"], "Hz |", file.attrs["axes"]
    )
    for name, dataset in file.items():
        if np.issubdtype(dataset.dtype, np.floating):
            axes = ", ".join(axis[0].name.strip("/") for axis in dataset.dims if len(axis))
            print(f"  {name:22} {dataset.shape!s:16} {axes:40} {dataset.attrs['unit']}")
    coordinates = list(file["coordinate_names"].asstr())
    knee = coordinates.index("knee_angle_r")
    knee_rad, sd_rad = file["angles"][:, knee], file["angles_sd"][:, knee]
    vertical_n = file["foot_wrench"][:, :, 2]  # right and left foot
    settings = json.loads(file.attrs["settings"])
    subject = json.loads(file.attrs["subject"])

print(f"knee from {np.degrees(knee_rad.min()):.1f} to {np.degrees(knee_rad.max()):.1f} deg")
print(
    f"mean sd {np.degrees(sd_rad.mean()):.2f} deg; mass {subject['mass_kg']:.1f} kg; filter {settings['filter']}"
)

assert (sd_rad > 0.0).all()
assert 0.5 < vertical_n.sum(axis=1).mean() / (9.80665 * subject["mass_kg"]) < 1.5

with xarray.open_dataset("result/motion.h5", engine="h5netcdf") as motion:
    right_n = motion.foot_wrench.sel(foot="right", wrench="force_z")
    np.testing.assert_array_equal(right_n, vertical_n[:, 0])
    print(motion.angles.sel(coordinate_names="knee_angle_r"))
    print(dict(zip(motion.footing.flag_values, motion.footing.flag_meanings.split(), strict=True)))
