"""A marker set of one's own: a protocol file, what it can observe, and a person scaled and reconstructed with it.

A laboratory follows pelvis and legs with 19 markers under names of its own (``my_legs.toml``, beside this script).
Head, trunk and arms carry none.
"""

from pathlib import Path
from subprocess import run
from sys import executable

import numpy as np

import mbkf

FILE = str(Path(__file__).with_name("my_legs.toml"))
protocol = mbkf.load_protocol(FILE)
print(f"{protocol.title}: {', '.join(marker.name for marker in protocol.markers[:6])} …")

# What the set determines, and what it no longer does when markers are lost.
for words in ([], ["--lost", "thigh_r,knee_r"]):
    told = run(
        [executable, "-m", "mbkf", "observability", FILE, *words], check=True, capture_output=True, text=True
    )
    print(told.stdout)

# Scale and reconstruct with it. The synthetic capture has more markers; those the protocol does not name are left out.
_, recorded = mbkf.synthesise("squat", seconds=1.0, seed=5)
subject = mbkf.scale(recorded.static, protocol=protocol)
causal = mbkf.ReconstructSettings(smooth=False)
result = mbkf.reconstruct(recorded.trial, subject, settings=causal)
knee_deg = np.degrees(result.angle("knee_angle_r"))
print(f"{len(result.marker_names)} markers followed; knee up to {knee_deg.max():.0f} deg")
print(f"{len(result.unobserved_dofs)} dofs move no marker and keep the neutral posture")

reference = mbkf.reconstruct(recorded.trial, mbkf.scale(recorded.static), settings=causal)
apart_deg = np.degrees(result.angle("knee_angle_r") - reference.angle("knee_angle_r"))
print(f"knee angle {np.sqrt(np.mean(apart_deg**2)):.1f} deg RMS from that of all 36 markers")

assert len(result.marker_names) == 19
assert np.sqrt(np.mean(apart_deg**2)) < 5.0
