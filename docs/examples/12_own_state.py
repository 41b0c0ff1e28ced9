"""A block with a state of its own, offline: an altimeter on the pelvis whose zero drifts.

z = p_z(q) + b + r, r ~ N(0, (5 mm)²), where p_z is the height of the pelvis and the drift b is a random walk of
20 mm/√s that the filter estimates beside the body. The pelvis moves in its own axes, hence a row of its rotation.
"""

import numpy as np

import mbkf

SD_M, DRIFT = 0.005, "altimeter_drift"


class Altimeter(mbkf.Block):
    """Height (1,) of the pelvis, m; NaN: missing."""

    def states(self):
        return [mbkf.ExtraState(DRIFT, start=np.zeros(1), start_sd=np.ones(1), walk_sd=np.array([0.02]))]

    def decide(self, at, frame, memory, notes):
        return frame.readings["altimeter"]

    def linearise(self, at, decision):
        if np.isnan(decision).any():
            return None
        x, y, z, w = at.state.q[3:7]
        H = np.zeros((1, self.layout.size))
        H[0, :3] = 2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)
        H[0, self.layout[DRIFT]] = 1.0
        drift = at.state.extra[self.layout.extra_index(DRIFT)]
        return mbkf.Rows(H / SD_M, (decision - at.state.q[2] - drift) / SD_M, readings=1)


person, recorded = mbkf.synthesise("squat", seconds=2.0, seed=6)
trial, height_m = recorded.trial, recorded.truth.q[:, 2]
rng, frames = np.random.default_rng(1), trial.markers.frames
drift_m = 0.3 + np.cumsum(rng.normal(size=frames)) * 0.02 / np.sqrt(trial.markers.rate_hz)
altimeter = (height_m + drift_m + SD_M * rng.normal(size=frames))[:, None]

gap = mbkf.ReconstructSettings(hide=(mbkf.Hidden(trial.markers.names, from_s=0.6, to_s=0.8),))
errors = {}
for name, blocks in {"markers alone": [], "and altimeter": [Altimeter()]}.items():
    result = mbkf.reconstruct(trial, person, settings=gap, blocks=blocks, readings={"altimeter": altimeter})
    inside = (result.times_s > 0.6) & (result.times_s < 0.8)
    errors[name] = 1e3 * np.sqrt(np.mean((result.q[inside, 2] - height_m[inside]) ** 2))
    print(f"{name}: height of the pelvis {errors[name]:.1f} mm RMS from the truth while no marker is seen")
assert errors["and altimeter"] < 0.8 * errors["markers alone"]
