"""A sensor of one's own: a pressure insole that stands in for a force plate, without touching the package.

z = [f_z, c_x, c_y, c_z] per foot: vertical force and centre of pressure, in world axes. About the centre of
pressure the horizontal moment vanishes, so that each reading is linear in the foot's wrench w = (f, n):

    f_z = w_3 + r,   0 = n_x − (c_y f_z − c_z f_y) + r,   0 = n_y − (c_z f_x − c_x f_z) + r
"""

import numpy as np

import mbkf

FORCE_SD_N, MOMENT_SD_NM = 20.0, 4.0


class Insole(mbkf.Block):
    """Readings (2, 4) of right and left foot: vertical force N, centre of pressure m."""

    def decide(self, at, frame, memory, notes):
        return frame.readings["insole"]

    def linearise(self, at, decision):
        rows, values = np.zeros((6, 12)), np.zeros(6)
        for foot, (force, cx, cy, cz) in enumerate(decision):
            w, H = at.state.w[6 * foot : 6 * foot + 6], np.zeros((3, 6))
            H[0, 2] = 1.0 / FORCE_SD_N
            H[1, [1, 2, 3]] = np.array([cz, -cy, 1.0]) / MOMENT_SD_NM
            H[2, [0, 2, 4]] = np.array([-cz, cx, 1.0]) / MOMENT_SD_NM
            if np.isfinite(force):
                rows[3 * foot : 3 * foot + 3, 6 * foot : 6 * foot + 6] = H
                values[3 * foot : 3 * foot + 3] = [force / FORCE_SD_N, 0.0, 0.0] - H @ w
        return mbkf.Rows(rows, values, self.layout.wrench.start, readings=6)


person, recorded = mbkf.synthesise("squat", seconds=2.5, seed=3)
trial, truth = recorded.trial, recorded.truth.foot_wrench
(fx, fy, fz), (nx, ny, _) = truth[..., :3].T, truth[..., 3:].T
cop = np.where(fz > 20.0, [fz, -ny / fz, nx / fz, 0 * fz], np.nan).T
insole = cop + np.random.default_rng(0).normal(size=cop.shape) * [10.0, 0.005, 0.005, 0.0]

kept = trial.plates[1:]
wrenches = mbkf.plate_wrenches(kept, trial.markers.times_s, trial.markers.rate_hz)
known = dict(markers=trial.markers.names, plates=kept, rate_hz=trial.markers.rate_hz)
errors = {}
for name, extra in {"plate withheld": [], "and insole": [Insole()]}.items():
    blocks = [*mbkf.standard_blocks(person, **known), *extra]
    tracker, error = mbkf.Tracker(person, **known, blocks=blocks), []
    for markers_m, plates, reading in zip(trial.markers.positions_m, wrenches, insole, strict=True):
        estimate = tracker.push(markers_m, plates, readings={"insole": reading})
        if estimate is not None:
            error.append(estimate.wrenches[0, 2] - truth[estimate.number, 0, 2])
    errors[name] = np.sqrt(np.mean(np.square(error)))
    print(f"{name}: vertical force under the right foot {errors[name]:.1f} N RMS from the truth")
assert errors["and insole"] < 0.7 * errors["plate withheld"]
