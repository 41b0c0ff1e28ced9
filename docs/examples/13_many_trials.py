"""Many trials: a study in a folder, its tables, and the knee angles of all cycles as a matrix for spm1d."""

import shutil
from pathlib import Path
from subprocess import run
from sys import executable

import pyarrow.parquet as pq

import mbkf

# A study as a laboratory stores it: two persons, each with a standing trial and a walk.
for person in ("P01", "P02"):
    seed = person[-1]
    words = ["--motion", "walk", "--seconds", "2.5", "--seed", seed, "--out", f"made/{person}"]
    run([executable, "-m", "mbkf", "synth", *words], check=True)
    Path("study", person).mkdir(parents=True)
    for file, name in (("static.c3d", "static.c3d"), ("trial.c3d", "walk.c3d")):
        shutil.copy(Path("made", person, file), Path("study", person, name))

settings = mbkf.ReconstructSettings(filter="kinematic", smooth=False)
table = mbkf.batch("study", "results", workers=1, settings=settings)
for row in table.select(["subject", "trial", "status", "marker_rms_mm"]).to_pylist():
    print(row)

asked = [("quantity", "==", "angle"), ("name", "==", "knee_angle")]
curves = pq.read_table("results/curves.parquet", filters=asked)
knee_deg = curves["value"].to_numpy().reshape(-1, 101)  # a row per cycle
print(f"{len(knee_deg)} cycles, knee from {knee_deg.min():.0f} to {knee_deg.max():.0f} degrees")

assert set(table["status"].to_pylist()) == {"done"}
assert len(knee_deg) >= 2 and 40.0 < knee_deg.max() < 90.0
