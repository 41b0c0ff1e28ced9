"""A laboratory's capture of a true motion: labelled trial, unlabelled twin, static trial, and the truth."""

from __future__ import annotations

from dataclasses import asdict, dataclass

import numpy as np

from mbkf.errors import InvalidInput
from mbkf.io.records import Capture, MarkerTrajectories
from mbkf.io.subject import Subject
from mbkf.io.truth import Truth
from mbkf.model.body import Body
from mbkf.model.clinical import configuration_names, dof_names
from mbkf.synthesis import cameras, plates
from mbkf.synthesis.motion import TrueMotion, synthesise_motion
from mbkf.synthesis.person import body_of
from mbkf.version import __version__

STATIC_SECONDS = 1.5


@dataclass(frozen=True)
class CaptureSettings:
    """Errors of the instruments.

    Attributes:
        markers_sd_m: White camera noise per coordinate.
        skin_sd_m: Stationary standard deviation of the skin's movement per coordinate.
        skin_cutoff_hz: Its bandwidth.
        occlusion: Fraction of samples hidden, in streaks of 20 frames.
        ghosts: Most ghost reflections at a time, in the unlabelled capture.
        force_sd_n: White noise per force channel of a plate.
        moment_sd_nm: White noise per moment channel.
        offset_n: Range of the vertical offset of plates; (0, 0): no offset.
    """

    markers_sd_m: float = 0.0005
    skin_sd_m: float = 0.003
    skin_cutoff_hz: float = 0.8
    occlusion: float = 0.02
    ghosts: int = 2
    force_sd_n: float = 1.0
    moment_sd_nm: float = 0.2
    offset_n: tuple[float, float] = (-25.0, -10.0)

    def __post_init__(self) -> None:
        for name in ("markers_sd_m", "skin_sd_m", "force_sd_n", "moment_sd_nm", "ghosts"):
            if not (np.isfinite(getattr(self, name)) and getattr(self, name) >= 0):
                raise InvalidInput(f"{name} must be 0 or more, got {getattr(self, name)}")
        if not 0.0 <= self.occlusion <= 0.9:
            raise InvalidInput(f"the hidden fraction lies between 0 and 0.9, got {self.occlusion}")
        if not 0.0 < self.skin_cutoff_hz < 10.0:
            raise InvalidInput(f"the skin moves at 0 to 10 Hz, got {self.skin_cutoff_hz} Hz")


@dataclass(frozen=True)
class SyntheticCapture:
    """The records of the instruments, and the truth.

    Attributes:
        trial: Labelled capture; its plates hold their readings as stored, offset included.
        raw: The same points without labels (``*0`` …), in a new order in every frame, with ghosts.
        static: Labelled capture of the subject standing.
        truth: The exact motion behind ``trial``.
    """

    trial: Capture
    raw: Capture
    static: Capture
    truth: Truth


def synthesise_capture(
    subject: Subject, motion: TrueMotion, settings: CaptureSettings | None = None, seed: int = 0
) -> SyntheticCapture:
    """Records a true motion of a subject with imperfect instruments, differently for every seed.

    Args:
        subject: The person that moves.
        motion: The exact motion.
        settings: Errors of the instruments.
        seed: Chooses the errors and the static trial.

    Raises:
        NotConverged: The subject cannot stand for the static trial.
    """
    chosen = settings or CaptureSettings()
    rng = np.random.default_rng([seed, 2])
    model = body_of(subject)
    trial, exact = _record(model, subject, motion, chosen, rng)
    positions = trial.markers.positions_m
    points = np.concatenate([positions, cameras.ghosts(exact, chosen.ghosts, motion.rate_hz, rng)], axis=1)
    names = tuple(f"*{k}" for k in range(points.shape[1]))
    raw = Capture(
        "",
        MarkerTrajectories(names, cameras.without_labels(points, rng), motion.rate_hz),
        trial.plates,
        subject_mass_kg=subject.mass_kg,
    )
    standing = synthesise_motion(model, "stand", STATIC_SECONDS, motion.rate_hz, seed, subject.habit_deg)
    still = CaptureSettings(**{**asdict(chosen), "skin_sd_m": 0.0, "occlusion": 0.0})
    static, _ = _record(model, subject, standing, still, rng)
    truth = Truth(
        times_s=motion.times_s,
        dof_names=dof_names(model),
        configuration_names=configuration_names(model),
        q=motion.q,
        v=motion.v,
        a=motion.a,
        tau=motion.tau,
        foot_wrench=motion.foot_wrench,
        centre_of_pressure=motion.centre_of_pressure,
        marker_names=trial.markers.names,
        markers_m=exact,
        support_names=motion.support_names,
        support_wrench=motion.support_wrench,
        version=__version__,
        settings={"motion": motion.name, "rate_hz": motion.rate_hz, "seed": seed, **asdict(chosen)},
    )
    return SyntheticCapture(trial, raw, static, truth)


def _record(
    model: Body,
    subject: Subject,
    motion: TrueMotion,
    settings: CaptureSettings,
    rng: np.random.Generator,
) -> tuple[Capture, np.ndarray]:
    """A labelled capture, and the exact (T, M, 3) positions of its markers."""
    exact = cameras.true_markers(model, subject, motion.q)
    seen = exact + settings.markers_sd_m * rng.standard_normal(exact.shape)
    seen += cameras.skin_artefact(
        exact.shape, motion.rate_hz, settings.skin_sd_m, settings.skin_cutoff_hz, rng
    )
    seen[cameras.occlusions(exact.shape[0], exact.shape[1], settings.occlusion, rng)] = np.nan
    names = tuple(marker.name for marker in subject.markers)
    stored = plates.readings(
        motion.plate_wrench,
        motion.plate_surface_m,
        motion.plate_rate_hz,
        settings.force_sd_n,
        settings.moment_sd_nm,
        settings.offset_n,
        rng,
        motion.belts,
    )
    return Capture(
        "",
        MarkerTrajectories(names, seen, motion.rate_hz),
        stored,
        events=plates.contact_events(motion.plate_wrench, motion.plate_rate_hz),
        subject_mass_kg=subject.mass_kg,
    ), exact
