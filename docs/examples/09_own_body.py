"""A body of one's own: pelvis and legs from a file, scaled and reconstructed from markers on the legs alone.

``bodies/legs.toml`` is a whole body file. Trunk, head and arms are part of its pelvis, rigid and upright, so that the
masses sum to the person's. Markers of the protocol that sit on segments the body does not have are left out.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np

import mbkf

body = mbkf.load_body(Path(__file__).parent / "bodies" / "legs.toml")
print(f"{body.name}: {len(body.segments)} segments, feet {body.roles.feet}")
for joint in body.clinical_joints:
    print(f"  {joint.name}: {', '.join(angle.name for angle in joint.angles)}")

_, recorded = mbkf.synthesise("squat", seconds=1.0, seed=5)
subject = mbkf.scale(recorded.static, body=body)
print(f"{len(subject.markers)} markers on the legs; the subject carries the body '{subject.body}'")

causal = mbkf.ReconstructSettings(smooth=False)
reference = mbkf.reconstruct(recorded.trial, mbkf.scale(recorded.static), settings=causal)
for name in ("kinematic", "dynamic", "torque"):
    result = mbkf.reconstruct(recorded.trial, subject, settings=replace(causal, filter=name))
    apart_deg = np.degrees(result.angle("knee_angle_r") - reference.angle("knee_angle_r"))
    rms_deg = np.sqrt(np.nanmean(apart_deg**2))
    print(f"{name}: knee angle {rms_deg:.1f} deg RMS from that of the whole body and all markers")
    assert rms_deg < 3.0

assert len(result.coordinate_names) == 26
