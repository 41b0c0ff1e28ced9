"""A loop of one's own: frames in, torques and angles with standard deviations out."""

import mbkf

person, recorded = mbkf.synthesise("walk", seconds=1.5, seed=2)
trial = recorded.trial
tracker = mbkf.Tracker(
    person, markers=trial.markers.names, plates=trial.plates, rate_hz=trial.markers.rate_hz
)
wrenches = mbkf.plate_wrenches(trial.plates, trial.markers.times_s, trial.markers.rate_hz)
for markers_m, plates in zip(trial.markers.positions_m, wrenches, strict=True):
    estimate = tracker.push(markers_m, plates)
    if estimate is not None and estimate.number % 30 == 0:
        knee, sd = estimate.torques["knee_angle_r"], estimate.torques_sd["knee_angle_r"]
        angle, angle_sd = estimate.angles["knee_angle_r"], estimate.angles_sd["knee_angle_r"]
        print(f"{estimate.number:4d}  knee {angle:6.3f} ± {angle_sd:.3f} rad, {knee:6.1f} ± {sd:.1f} N m")
assert estimate is not None and estimate.tracked and 0.0 < sd < 20.0
