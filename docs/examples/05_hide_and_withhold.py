"""Test an estimate honestly: hide markers and withhold a plate, then compare with what was hidden.

A residual of zero proves nothing by itself. A marker that was hidden on purpose and a plate that the filter did not
read are independent checks that any capture allows.
"""

from dataclasses import replace

import numpy as np

import mbkf

subject, recorded = mbkf.synthesise("squat", seconds=2.0, seed=4)
complete = mbkf.ReconstructSettings(smooth=False)  # as a live run: no frame knows later ones

# All markers of the right shank are hidden for 0.3 s.
shank = tuple(marker.name for marker in subject.markers if marker.segment == "right_shank")
hidden = replace(complete, hide=(mbkf.Hidden(shank, from_s=0.8, to_s=1.1),))
found = mbkf.summarise(mbkf.reconstruct(recorded.trial, subject, settings=hidden))
print(f"{', '.join(shank)} hidden for 0.3 s: {found['hidden_marker_rms_mm']:.1f} mm RMS where they were")

# The left plate is withheld: the left foot's wrench is estimated from the markers and the other plate.
left = recorded.trial.plates[1].name
withheld = replace(complete, without_plates=(left,))
with_plate = mbkf.reconstruct(recorded.trial, subject, settings=complete)
without = mbkf.reconstruct(recorded.trial, subject, settings=withheld)
error_n = (without.foot_wrench - with_plate.foot_wrench)[:, 1, 2]
stated_n = np.sqrt(np.mean(without.foot_wrench_sd[:, 1, 2] ** 2))
rms_n = np.sqrt(np.mean(error_n**2))
weight_n = 9.80665 * subject.mass_kg
print(
    f"plate {left} withheld: vertical force to {rms_n:.0f} N RMS (stated: {stated_n:.0f} N; weight {weight_n:.0f} N)"
)

assert found["hidden_marker_rms_mm"] < 60.0
assert rms_n < 0.25 * weight_n
