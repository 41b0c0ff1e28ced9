"""A result as C3D with plates and analog channels, read as Visual3D and Mokka read it; and as Visual3D's table."""

from pathlib import Path
from subprocess import run
from sys import executable

import ezc3d
import numpy as np

import mbkf

for words in (
    "synth --motion walk --seconds 1 --seed 3 --out lab",
    "reconstruct lab/trial.c3d --subject lab/subject.toml --out result",
    "export result --to c3d --trial lab/trial.c3d --out walk_model.c3d",
    "export result --to v3d --out walk_model.txt",
):
    run([executable, "-m", "mbkf", *words.split()], check=True, capture_output=True)

file = ezc3d.c3d("walk_model.c3d", extract_forceplat_data=True)
plates = file["parameters"]["FORCE_PLATFORM"]
print(plates["USED"]["value"], "plates of type", plates["TYPE"]["value"])
for words, plate in zip(plates["DESCRIPTIONS"]["value"], file["data"]["platform"], strict=True):
    print(f"  {words}: at most {np.abs(plate['force'][2]).max():.0f} N")

heading = [line.split("\t")[1:4] for line in Path("walk_model.txt").read_text().splitlines()[:5]]
print(*heading, sep="\n")

read = mbkf.read_capture("lab/trial.c3d").plates
for ours, theirs in zip(read, file["data"]["platform"], strict=False):  # the measured ones stand first
    assert np.abs(theirs["force"].T - ours.force_n).max() < 0.1
