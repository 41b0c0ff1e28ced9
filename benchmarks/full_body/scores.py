"""What is measured on one reconstruction of a synthetic trial: errors, delays, noise, residual, innovation."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from benchmarks.full_body.trials import Trial
from benchmarks.references import low_pass, rms
from benchmarks.thesis_report.delay import delay
from mbkf.conventions import Array, BoolArray
from mbkf.io.results import Reconstruction
from mbkf.model.body import Body
from mbkf.model.clinical import ClinicalAngles
from mbkf.model.newton_euler import NewtonEuler
from mbkf.synthesis.person import body_of
from mbkf.trial.results.summary import ROOT_DOFS

DIVERGED_DEG = 10.0
"""A reconstruction with a larger RMS error of its angles, or with numbers that are not finite, has diverged."""

NOISE_FROM_HZ = 6.0
"""Noise of a curve: its error above this frequency, where these movements have little left."""

SETTLING_S = 0.3
"""Start of a trial that is not judged: the filters settle there."""

AFTER_S = 0.5
"""How long after lost markers come back torques are judged as well."""

LEGS = ("thigh", "shank", "foot")


@dataclass(frozen=True)
class Scores:
    """Numbers of one reconstruction; RMS over frames and dofs of the joints.

    Attributes:
        angle_deg: Error of posture in the tangent space.
        velocity_rad_s, torque_nm: Errors of velocities and torques.
        reaction_n: Error of the feet's forces, per component.
        marker_mm: Distance of measured markers from the reconstructed body.
        velocity_delay_ms, torque_delay_ms: By how much velocities and torques of the legs lag behind the truth.
        velocity_noise_rad_s, torque_noise_nm: Their errors above :data:`NOISE_FROM_HZ`, over the legs.
        residual_before_n: Force that Newton's law lacks in the prediction from the frame before, with measured plates.
        residual_n: The same after correction.
        residual_everywhere_n: After correction, over all frames, also those in which a foot stands beside the plates.
        nis: Normalised innovation squared per reading.
        knee_deg: Largest error of the right knee's rotation in the stretch in which markers may be lost; NaN elsewhere.
        flexion_deg: The same of its flexion alone.
        knee_torque_nm: RMS error of the right knee's flexion torque there and half a second after.
        knee_lateral_nm: The same of its torque about the forward axis.
        untracked: Frames without the body.
    """

    angle_deg: float
    velocity_rad_s: float
    torque_nm: float
    reaction_n: float
    marker_mm: float
    velocity_delay_ms: float
    torque_delay_ms: float
    velocity_noise_rad_s: float
    torque_noise_nm: float
    residual_before_n: float
    residual_n: float
    residual_everywhere_n: float
    nis: float
    knee_deg: float
    flexion_deg: float
    knee_torque_nm: float
    knee_lateral_nm: float
    untracked: int

    @property
    def diverged(self) -> bool:
        """Whether the posture is lost."""
        return not self.angle_deg <= DIVERGED_DEG


def score(trial: Trial, found: Reconstruction, measured_wrench: Array) -> Scores:
    """Compares a reconstruction with the truth.

    Args:
        trial: The trial.
        found: Its reconstruction.
        measured_wrench: (T, 2, 6) wrenches that the plates measured under right and left foot.
    """
    truth, model = trial.truth, body_of(trial.subject)
    judged = found.times_s >= found.times_s[0] + SETTLING_S
    posture = posture_error(model, truth.q, found.q)
    velocity, torque = (truth.v - found.v)[:, ROOT_DOFS:], (truth.tau - found.tau)[:, ROOT_DOFS:]
    legs = leg_columns(model)
    angle = np.rad2deg(plain_rms(posture[judged][:, ROOT_DOFS:]))
    lost = not angle <= DIVERGED_DEG
    times = found.times_s
    before = np.nan if lost else prediction_residual_n(model, found, measured_wrench)
    return Scores(
        angle_deg=float(angle),
        velocity_rad_s=plain_rms(velocity[judged]),
        torque_nm=plain_rms(torque[judged]),
        reaction_n=plain_rms((truth.foot_wrench - found.foot_wrench)[judged][..., :3]),
        marker_mm=marker_error_mm(found),
        velocity_delay_ms=1e3
        * delay(times, truth.v[:, ROOT_DOFS:][:, legs], found.v[:, ROOT_DOFS:][:, legs]),
        torque_delay_ms=1e3
        * delay(times, truth.tau[:, ROOT_DOFS:][:, legs], found.tau[:, ROOT_DOFS:][:, legs]),
        velocity_noise_rad_s=noise(velocity[:, legs], judged, found.rate_hz),
        torque_noise_nm=noise(torque[:, legs], judged, found.rate_hz),
        residual_before_n=before,
        residual_n=rms(np.linalg.norm(found.residual_force_n[found.measured], axis=1)),
        residual_everywhere_n=rms(np.linalg.norm(found.residual_force_n[judged], axis=1)),
        nis=innovation(found, judged),
        **_knee(trial, found, model, posture, torque),
        untracked=int((~found.tracked).sum()),
    )


def posture_error(model: Body, truth_q: Array, found_q: Array) -> Array:
    """(T, nv) tangent vectors from estimated to true configurations; NaN where an estimate is none.

    Args:
        model: The body.
        truth_q: (T, nq) true configurations.
        found_q: (T, nq) estimated ones.
    """
    error = np.full((len(found_q), model.nv), np.nan)
    for t in np.flatnonzero(np.isfinite(found_q).all(axis=1)):
        error[t] = model.difference(found_q[t], truth_q[t])
    return error


def leg_columns(model: Body) -> Array:
    """Columns of hips, knees and ankles among the dofs of the joints."""
    own = [joint.v for name, joint in model.joints.items() if name.endswith(LEGS)]
    return np.concatenate([np.arange(v.start, v.stop) for v in own]) - ROOT_DOFS


def plain_rms(error: Array) -> float:
    """Root mean square of all values; infinite where one is no number."""
    with np.errstate(over="ignore"):
        value = float(np.sqrt(np.mean(np.square(error)))) if error.size else np.nan
    return value if np.isfinite(value) else np.inf


def noise(error: Array, judged: BoolArray, rate_hz: float) -> float:
    """RMS of an error (T, k) above :data:`NOISE_FROM_HZ`, over the judged frames.

    Args:
        error: (T, k) error.
        judged: (T,) frames that count.
        rate_hz: Frame rate.
    """
    if not np.isfinite(error).all():
        return np.inf
    return plain_rms((error - low_pass(error, rate_hz, NOISE_FROM_HZ))[judged])


def prediction_residual_n(model: Body, found: Reconstruction, measured_wrench: Array) -> float:
    """RMS force that Newton's law lacks in the motion predicted from the frame before, under the measured plates.

    The prediction goes on with constant acceleration. Judged are frames in which plates carry every loaded foot.

    Args:
        model: The body.
        found: A reconstruction.
        measured_wrench: (T, 2, 6) wrenches that the plates measured under right and left foot.
    """
    balance, dt = NewtonEuler(model), 1.0 / found.rate_hz
    missing = []
    for t in np.flatnonzero(found.measured[1:] & found.tracked[:-1]):
        q, v, a = found.q[t], found.v[t], found.a[t]
        if not (np.isfinite(q).all() and np.isfinite(a).all()):
            continue
        ahead = model.integrate(q, dt * v + 0.5 * dt**2 * a)
        needed = balance.tau(ahead, v + dt * a, a, measured_wrench[t + 1].ravel())
        missing.append(np.linalg.norm(needed[:3]))
    return rms(np.array(missing))


def marker_error_mm(found: Reconstruction) -> float:
    """RMS distance of measured markers from the reconstructed body, mm."""
    distance = np.linalg.norm(found.measured_m - found.predicted_m, axis=2)
    return 1e3 * rms(distance[found.present])


def innovation(found: Reconstruction, judged: BoolArray) -> float:
    """Mean normalised innovation squared per reading over the judged frames (T,); NaN where there is none."""
    counted = judged & (found.nis_readings > 0) & np.isfinite(found.nis)
    return float(np.mean(found.nis[counted] / found.nis_readings[counted])) if counted.any() else np.nan


def _knee(
    trial: Trial, found: Reconstruction, model: Body, posture: Array, torque: Array
) -> dict[str, float]:
    """The numbers of the right knee, by name."""
    stretch = trial.stretch
    if not stretch.any():
        return dict.fromkeys(("knee_deg", "flexion_deg", "knee_torque_nm", "knee_lateral_nm"), np.nan)
    v = model.joint("right_shank").v
    about = np.rad2deg(np.linalg.norm(posture[stretch][:, v], axis=1))
    column = found.coordinate_names.index("knee_angle_r")
    flexion = found.angles[:, column] - clinical_flexion(model, trial.truth.q)
    and_after = stretch.copy()
    last = int(np.flatnonzero(stretch)[-1])
    and_after[last : last + round(AFTER_S * found.rate_hz)] = True
    lateral, flexing = v.start - ROOT_DOFS, v.start + 1 - ROOT_DOFS
    return {
        "knee_deg": float(np.max(about)),
        "flexion_deg": float(np.rad2deg(np.abs(flexion[stretch]).max())),
        "knee_torque_nm": plain_rms(torque[and_after, flexing]),
        "knee_lateral_nm": plain_rms(torque[and_after, lateral]),
    }


def clinical_flexion(model: Body, q: Array) -> Array:
    """(T,) clinical flexion angle of the right knee, rad, of configurations (T, nq)."""
    clinical = ClinicalAngles(model)
    return np.asarray(clinical.angles(q)[:, clinical.names.index("knee_angle_r")])
