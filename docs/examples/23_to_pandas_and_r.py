"""A result as a wide table: pandas makes strides of equal length of it, as spm1d and R take them."""

from itertools import pairwise
from subprocess import run
from sys import executable

import numpy as np
import pandas as pd

import mbkf

for words in (
    "synth --motion walk --seconds 2 --seed 3 --out lab",
    "reconstruct lab/trial.c3d --subject lab/subject.toml --out result",
    "export result --to csv --out walk.csv",
    "export result --to summary --out walk_summary.csv",
):
    run([executable, "-m", "mbkf", *words.split()], check=True, capture_output=True)

walk = pd.read_csv("walk.csv", index_col="time_s")
print(
    f"{len(walk)} frames, {len(walk.columns)} columns:", ", ".join(walk.filter(like="knee_angle_r").columns)
)
print(
    pd.read_csv("walk_summary.csv").loc[0, ["marker_rms_mm", "knee_r_peak_nm_per_kg", "verdict"]].to_string()
)

loaded = walk.right_foot_force_z_n > 20.0
strikes = walk.index[loaded & ~loaded.shift(fill_value=True)]
percent = np.arange(101)
strides = np.array(
    [
        np.interp(first + percent / 100 * (last - first), walk.index, walk.knee_angle_r_deg)
        for first, last in pairwise(strikes)
    ]
)  # strides by percent: Y of spm1d.stats.ttest(Y, mu), spm1d.stats.ttest2(YA, YB)
print(f"{len(strides)} strides of the right leg, knee flexion {strides.min():.0f} to {strides.max():.0f} deg")
pd.DataFrame(strides.T, index=pd.Index(percent, name="percent")).to_csv("knee_strides.csv")

result = mbkf.read_reconstruction("result")
np.testing.assert_allclose(np.radians(walk.knee_angle_r_deg), result.angle("knee_angle_r"), atol=1e-9)
assert strides.shape[0] >= 1 and strides.max() > 40.0
