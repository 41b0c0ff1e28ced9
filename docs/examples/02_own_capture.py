"""Your own capture: read a static trial, scale the body, reconstruct a movement trial, write the results.

With files of your own, skip the first block and put your file names in the others.
"""

from pathlib import Path
from subprocess import run
from sys import executable

import mbkf

# Make files as a laboratory stores them: static.c3d, trial.c3d (with force plates), truth.h5 and others.
run([executable, "-m", "mbkf", "synth", "--motion", "squat", "--seconds", "1", "--out", "lab"], check=True)

# Scale: 18 factors and the marker positions on this person, from a standing trial.
static = mbkf.read_capture("lab/static.c3d")
subject = mbkf.scale(static, mass_kg=static.subject_mass_kg)
mbkf.write_subject(subject, "subject.toml")
print(
    f"{subject.protocol}: {len(subject.markers)} markers, thigh × {subject.scale_factors['right_thigh']:.3f}"
)

# Reconstruct: a C3D brings its own plates; a TRC takes them from forces="grf.mot".
trial = mbkf.read_capture("lab/trial.c3d")
print(f"{trial.markers.frames} frames at {trial.markers.rate_hz:g} Hz, {len(trial.plates)} plates")
result = mbkf.reconstruct(trial, mbkf.read_subject("subject.toml"))

# Write summary.json, motion.h5 and the files OpenSim opens.
mbkf.write_reconstruction(result, mbkf.summarise(result), "result")
written = sorted(path.name for path in Path("result").iterdir())
print("written:", ", ".join(written))

assert {"summary.json", "motion.h5", "angles.mot", "torques.sto", "reactions.mot", "markers.trc"} <= set(
    written
)
assert mbkf.read_reconstruction("result").frames == trial.markers.frames
