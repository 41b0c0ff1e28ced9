"""A goniometer on the right knee: a block that reads one clinical angle.

z = θ(q) + r, r ~ N(0, (0.02 rad)²), where θ is the knee's flexion. Its derivative lives in the tangent space of q.
"""

import numpy as np

import mbkf


class Goniometer(mbkf.Block):
    """Flexion (1,) of the knee, rad; NaN: missing."""

    def __init__(self, sd_rad=0.02, name="knee_angle_r"):
        self.sd_rad, self.name = sd_rad, name

    def bind(self, layout, body):
        self.angles = mbkf.ClinicalAngles(body)

    def decide(self, at, frame, memory, notes):
        return frame.readings.get("goniometer", np.full(1, np.nan))

    def linearise(self, at, decision):
        error = decision - self.angles.value(self.name, at.state.q)
        H = self.angles.jacobian(self.name, at.state.q)[None]
        return None if np.isnan(error).any() else mbkf.Rows(H / self.sd_rad, error / self.sd_rad, readings=1)


person, recorded = mbkf.synthesise("walk", seconds=2.5, seed=4)
trial, angles = recorded.trial, mbkf.ClinicalAngles(mbkf.HumanModel.of(person))
knee = np.array([angles.value("knee_angle_r", q) for q in recorded.truth.q])
goniometer = (knee + 0.02 * np.random.default_rng(0).normal(size=knee.shape))[:, None]

shank = ("RTUB", "RANK", "RHEE", "RMID", "RMT1", "RMT5", "RHAL")
gap = mbkf.ReconstructSettings(hide=(mbkf.Hidden(shank, from_s=0.8, to_s=2.2),))
errors = {}
for name, blocks in {"markers alone": [], "and goniometer": [Goniometer()]}.items():
    result = mbkf.reconstruct(trial, person, settings=gap, blocks=blocks, readings={"goniometer": goniometer})
    inside = (result.times_s > 0.8) & (result.times_s < 2.2)
    found = np.array([angles.value("knee_angle_r", q) for q in result.q[inside]])
    errors[name] = np.rad2deg(np.sqrt(np.mean((found - knee[inside]) ** 2)))
    print(f"{name}: knee {errors[name]:.1f}° RMS from the truth while no marker below it is seen")
assert errors["and goniometer"] < 0.5 * errors["markers alone"]
