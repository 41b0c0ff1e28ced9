"""First result: a synthetic squat with known truth, from markers and plates to angles and torques.

No files are needed. A random person performs a motion that obeys Newton's law exactly; imperfect cameras and force
plates record it; the default (dynamic) filter reconstructs it, and later frames correct earlier ones.
"""

import numpy as np

import mbkf

subject, recorded = mbkf.synthesise("squat", seconds=2.0, seed=1)
result = mbkf.reconstruct(recorded.trial, subject)

knee_deg = np.degrees(result.angle("knee_angle_r"))
knee_sd_deg = np.degrees(result.angle_sd("knee_angle_r"))
hip_nm = result.torque("hip_flexion_r")
deepest = int(np.argmax(knee_deg))
print(
    f"deepest at {result.times_s[deepest]:.2f} s: knee {knee_deg[deepest]:.1f} ± {knee_sd_deg[deepest]:.1f} deg"
)
print(f"hip flexion torque between {hip_nm.min():.0f} and {hip_nm.max():.0f} N m")

# The capture is synthetic, so errors against the truth are known.
summary = mbkf.summarise(result, recorded.truth)
print(f"markers: {summary['marker_rms_mm']:.1f} mm RMS")
print(f"joint torques: {summary['truth']['torque_rms_nm']:.2f} N m RMS from the truth")

assert summary["marker_rms_mm"] < 8.0
assert summary["truth"]["torque_rms_nm"] < 3.0
