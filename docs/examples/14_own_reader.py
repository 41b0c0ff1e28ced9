"""A reader of one's own: a text file with a row of x, y, z per frame and marker, and the names in its first line."""

from pathlib import Path

import numpy as np

import mbkf
from mbkf.io.axes import METRES_PER_UNIT


# A package that has these lines installed needs no more than an entry point.
@mbkf.register_reader(".xyz", title="rows of x y z")
def read_xyz(path: Path, options: mbkf.CaptureOptions) -> mbkf.Capture:
    """Markers at 100 Hz, z up, in mm where --unit names no other unit."""
    with path.open(encoding="utf-8") as file:
        names = tuple(file.readline().split())
        rows = np.loadtxt(file)
    positions_m = METRES_PER_UNIT[options.unit or "mm"] * rows.reshape(-1, len(names), 3)
    return mbkf.Capture(str(path), mbkf.MarkerTrajectories(names, positions_m, rate_hz=100.0))


# Every function that takes a capture reads such a file now.
person, recorded = mbkf.synthesise("squat", seconds=1.0, seed=3)
markers = recorded.trial.markers
rows = 1e3 * markers.positions_m.reshape(-1, 3)
np.savetxt("squat.xyz", rows, header=" ".join(markers.names), comments="", fmt="%.4f")
capture = mbkf.read_capture("squat.xyz")
result = mbkf.reconstruct(capture, person, settings=mbkf.ReconstructSettings(filter="kinematic"))
knee = np.rad2deg(result.angle("knee_angle_r"))
print(f"{len(capture.markers.names)} markers, right knee from {knee.min():.0f} to {knee.max():.0f} degrees")
assert np.ptp(knee) > 20.0
