"""Keypoints of markerless systems: a person scaled and followed from 26 or 43 points of 20 mm noise.

Persons stand, walk, squat and jump; their exact keypoints get noise of 20 mm per coordinate, 10 mm of which stay for
0.3 s (Gauss–Markov), in the standing trial as well, and gaps in 2 % of the samples. Everything is found as a user
would: the set by its names, the person from the standing trial and the movement.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from benchmarks.checks import Check, Context, information
from benchmarks.references import rms
from mbkf.conventions import Array
from mbkf.io.records import Capture
from mbkf.io.results import Reconstruction
from mbkf.io.subject import Subject
from mbkf.model.clinical import ClinicalAngles
from mbkf.synthesis.cameras import occlusions
from mbkf.synthesis.capture import CaptureSettings, synthesise_capture
from mbkf.synthesis.motion import TrueMotion, synthesise_motion
from mbkf.synthesis.motions import registered_motion
from mbkf.synthesis.person import body_of, synthesise_subject
from mbkf.trial.preparation.settings import ReconstructSettings
from mbkf.trial.reconstruct import reconstruct
from mbkf.trial.scale import scale

SETS, MOTIONS = ("halpe26", "opencap43"), ("walk", "squat", "jump")
SEEDS = (11, 12, 13)
NOISE_M, CORRELATED_M, CORRELATION_S, GAPS = 0.020, 0.010, 0.3, 0.02
RATE_HZ = 100.0

FLEXIONS = {"hip_flexion": "hip", "knee_angle": "knee", "ankle_angle": "ankle"}
ANGLE_BOUND_DEG, TORQUE_BOUND_NM_KG = 5.0, 0.25
SETTLING_S = 0.3
"""Start of a trial that is not judged."""

EXACT = CaptureSettings(markers_sd_m=0.0, skin_sd_m=0.0, occlusion=0.0, ghosts=0, offset_n=(0.0, 0.0))


@dataclass(frozen=True)
class Errors:
    """Errors of one reconstruction by joint, both sides one after the other.

    Attributes:
        angle_deg: Of the flexion angle, by joint.
        torque_nm_kg: Of its moment over body mass, in frames in which all reactions are measured.
        angle_sd_deg: Stated standard deviation of the angle.
    """

    angle_deg: dict[str, Array]
    torque_nm_kg: dict[str, Array]
    angle_sd_deg: dict[str, Array]


def keypoint_rows(context: Context) -> list[Check]:
    """The rows: RMS over persons, sides and frames, of smoothed results, and of causal ones for information."""
    found: dict[tuple[str, str, bool], list[Errors]] = {}
    for motion in MOTIONS:
        for seed in SEEDS[:1] if context.quick else SEEDS:
            body = body_of(synthesise_subject(seed, SETS[0]))
            moved = synthesise_motion(body, motion, registered_motion(motion).seconds, RATE_HZ, seed)
            for name in SETS:
                smoothed, causal = Scene.of(name, moved, seed).errors()
                found.setdefault((name, motion, True), []).append(smoothed)
                found.setdefault((name, motion, False), []).append(causal)
    return [check for key, errors in found.items() for check in _rows(*key, errors)]


def _rows(name: str, motion: str, smooth: bool, errors: list[Errors]) -> Iterator[Check]:
    for joint in FLEXIONS.values():
        angle = rms(np.concatenate([e.angle_deg[joint] for e in errors]))
        torque = rms(np.concatenate([e.torque_nm_kg[joint] for e in errors]))
        title = f"keypoints: {name}, {motion}, {joint}"
        if smooth:
            yield Check(f"{title}, flexion", angle, ANGLE_BOUND_DEG, "<=", "°")
            yield Check(f"{title}, torque", torque, TORQUE_BOUND_NM_KG, "<=", "N m/kg")
        else:
            yield information(f"{title}, flexion, causal", angle, "°")
            yield information(f"{title}, torque, causal", torque, "N m/kg")
    if smooth:
        inside = [np.abs(e.angle_deg[j]) <= 1.96 * e.angle_sd_deg[j] for e in errors for j in e.angle_deg]
        share = 100.0 * float(np.concatenate(inside).mean())
        yield information(f"keypoints: {name}, {motion}, flexion within its 95 % interval", share, "%")


@dataclass(frozen=True)
class Scene:
    """A person who stands and moves before cameras.

    Attributes:
        person: The person, exactly.
        motion: The true motion.
        static, trial: Keypoints of standing and of the motion; plates of the latter.
    """

    person: Subject
    motion: TrueMotion
    static: Capture
    trial: Capture

    @classmethod
    def of(cls, protocol: str, motion: TrueMotion, seed: int) -> Scene:
        """The scene of a person.

        Args:
            protocol: Name of the keypoints' set.
            motion: How the person moves.
            seed: Chooses person and noise; the person has the same body whatever the set.
        """
        person = synthesise_subject(seed, protocol)
        exact, rng = synthesise_capture(person, motion, EXACT, seed), np.random.default_rng([seed, 7])
        return cls(person, motion, noisy(exact.static, rng, 0.0), noisy(exact.trial, rng, GAPS))

    def errors(self) -> tuple[Errors, Errors]:
        """Errors of the motion found from the keypoints, smoothed and causal."""
        subject = scale(self.static, [self.trial], mass_kg=self.person.mass_kg)
        smoothed, causal = (
            reconstruct(self.trial, subject, settings=ReconstructSettings(smooth=smooth))
            for smooth in (True, False)
        )
        return compared(smoothed, self.person, self.motion), compared(causal, self.person, self.motion)


def noisy(capture: Capture, rng: np.random.Generator, gaps: float) -> Capture:
    """A capture whose exact points get the noise of keypoints.

    Args:
        capture: The exact one.
        rng: Source of the noise.
        gaps: Share of the samples that is missing.
    """
    points = capture.markers.positions_m
    white = rng.normal(0.0, np.sqrt(NOISE_M**2 - CORRELATED_M**2), points.shape)
    seen = points + white + gauss_markov(points.shape, rng)
    seen[occlusions(points.shape[0], points.shape[1], gaps, rng)] = np.nan
    return replace(capture, markers=replace(capture.markers, positions_m=seen))


def gauss_markov(shape: tuple[int, ...], rng: np.random.Generator) -> Array:
    """Stationary noise along the first axis that stays for a while.

    Args:
        shape: (T, …) of the result.
        rng: Its source.
    """
    rho = np.exp(-1.0 / (RATE_HZ * CORRELATION_S))
    found = rng.normal(0.0, CORRELATED_M, shape)
    for t in range(1, shape[0]):
        found[t] = rho * found[t - 1] + np.sqrt(1.0 - rho**2) * found[t]
    return found


def compared(found: Reconstruction, person: Subject, motion: TrueMotion) -> Errors:
    """Errors of a reconstruction.

    Args:
        found: It.
        person: Who moved.
        motion: How.
    """
    clinical = ClinicalAngles(body_of(person))
    angles = clinical.angles(motion.q)
    moments = clinical.moments(motion.q, motion.tau, angles)
    judged = found.times_s - found.times_s[0] >= SETTLING_S
    measured = judged & found.measured
    angle_deg, torque, sd = {}, {}, {}
    for coordinate, joint in FLEXIONS.items():
        pairs = [
            (found.coordinate_names.index(name), clinical.names.index(name))
            for name in (f"{coordinate}_r", f"{coordinate}_l")
        ]
        angle_deg[joint] = np.degrees(
            np.concatenate([found.angles[judged, ours] - angles[judged, true] for ours, true in pairs])
        )
        torque[joint] = np.concatenate(
            [found.moments[measured, ours] - moments[measured, true] for ours, true in pairs]
        )
        torque[joint] /= person.mass_kg
        sd[joint] = np.degrees(np.concatenate([found.angles_sd[judged, ours] for ours, _ in pairs]))
    return Errors(angle_deg, torque, sd)
