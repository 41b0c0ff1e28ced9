"""Compare the three filters, causal, and the smoother, on one capture with known truth.

``kinematic`` follows markers and solves for torques afterwards, ``torque`` is the thesis's filter with torques as
states, ``dynamic`` (the default) has accelerations and foot wrenches as states and Newton's law as a reading.
"""

import mbkf

subject, recorded = mbkf.synthesise("squat", seconds=1.0, seed=2)

runs = {
    "kinematic": mbkf.ReconstructSettings(filter="kinematic", smooth=False),
    "torque": mbkf.ReconstructSettings(filter="torque", smooth=False),
    "dynamic": mbkf.ReconstructSettings(filter="dynamic", smooth=False),
    "dynamic, smoothed": mbkf.ReconstructSettings(filter="dynamic"),
}
print(f"{'':18} {'markers mm':>10} {'residual N':>10} {'torques N m':>11} {'step ms':>8}")
torque_rms_nm = {}
for name, settings in runs.items():
    result = mbkf.reconstruct(recorded.trial, subject, settings=settings)
    found = mbkf.summarise(result, recorded.truth)
    torque_rms_nm[name] = found["truth"]["torque_rms_nm"]
    print(
        f"{name:18} {found['marker_rms_mm']:10.1f} {found['residual_force_rms_n']:10.2f}"
        f" {torque_rms_nm[name]:11.2f} {1e3 * found['step_seconds_median']:8.2f}"
    )

assert torque_rms_nm["dynamic"] < torque_rms_nm["kinematic"]
assert torque_rms_nm["dynamic, smoothed"] < torque_rms_nm["dynamic"]
