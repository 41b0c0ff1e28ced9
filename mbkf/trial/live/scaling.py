"""A person scaled from a stream: recognises standing still, and scales from those frames as from a static trial."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from mbkf.conventions import GRAVITY_M_S2, Array
from mbkf.errors import InvalidInput, NotObservable, UnknownName
from mbkf.io.records import Capture, PlateReadings
from mbkf.io.subject import Subject
from mbkf.labelling.assignment import squared_distances
from mbkf.model.clinical import ClinicalAngles
from mbkf.model.human import HumanModel
from mbkf.model.protocol import Protocol, detect_protocol
from mbkf.numerics.threads import single_threaded
from mbkf.scaling.frames import MIN_MARKERS
from mbkf.sensors.contact.causal import ContactDetector
from mbkf.sensors.contact.records import Contact
from mbkf.sensors.pose_fit import fit_pose, segment_by_segment
from mbkf.sensors.posture_sensor import PostureSensor
from mbkf.sensors.subject_sensor import subject_sensor
from mbkf.trial.label_unscaled import label_unscaled
from mbkf.trial.preparation.static_names import markers_as_scaled, under_names_of_static
from mbkf.trial.scale import scale

STILL_S = 1.0
"""Duration of standing still that a person is scaled from."""

STILL_M = 0.030
"""No marker moves further than this in that time. People asked to stand still sway: their hands move by up to 30 mm in
a second (medians over real standing trials 5 to 29 mm), those of a walking person by more than 400 mm."""

LEAST_SEEN = 0.8
"""Share of the markers worn that must be seen."""

STRAY = 0.1
"""Share of the points without names that may be ghosts, or markers that were hidden at first."""

LIGHTEST_KG = 10.0
"""Plates that carry less carry no person."""

BENDING = ("hip_flexion_r", "hip_flexion_l", "knee_angle_r", "knee_angle_l")
MOST_BENT_DEG = 60.0
"""Sitting and kneeling people bend hips or knees by 90°; standing ones, crouched knees included, by 40° at most."""

ON_PLATE = (Contact.MEASURED, Contact.SHARED)


@dataclass(frozen=True)
class Stance:
    """State of standing still after a frame.

    Attributes:
        frames: For how many frames in a row, the newest one included.
        seen: How many markers or points were seen in them.
        moved_m: How far the marker that moved most is from where it was first, m; 0 where too few are seen.
        mover: Which one that is, where markers have names.
        enough: Whether that is still enough, and markers seen, to scale the person.
    """

    frames: int
    seen: int
    moved_m: float
    mover: int | None
    enough: bool


class StillWatch:
    """Recognises, frame by frame, that a person has stood still for long enough.

    Each frame is compared with the first one since the last movement, so a slow drift does not pass for standing.

    Attributes:
        wanted: Number of frames in a row that are needed.
        least: Number of markers or points that must be seen.
    """

    def __init__(self, rate_hz: float, worn: int, named: bool) -> None:
        """A watch that has seen no frame yet.

        Args:
            rate_hz: Frame rate.
            worn: Number of markers the person wears.
            named: Whether the rows of a frame are always the same markers.
        """
        self.wanted = max(2, round(STILL_S * rate_hz))
        self.least = max(MIN_MARKERS, int(np.ceil(LEAST_SEEN * worn)))
        self._named = named
        self.restart()

    def restart(self) -> None:
        """Forgets what was seen."""
        self._first, self._frames = np.zeros((0, 3)), 0

    def push(self, points_m: Array) -> Stance:
        """The next frame.

        Args:
            points_m: (M, 3) markers, NaN where missing; without names (N, 3) points in any order.
        """
        present = ~np.isnan(points_m).any(axis=1)
        if present.sum() < MIN_MARKERS:
            self.restart()
            return Stance(0, int(present.sum()), 0.0, None, False)
        points = points_m if self._named else points_m[present]
        moved_m, mover = self._moved(points) if self._frames else (0.0, None)
        if not self._frames or moved_m > STILL_M:
            self._first, self._frames = points, 0
        elif self._named:
            self._first = np.where(np.isnan(self._first), points, self._first)
        self._frames += 1
        seen = int((~np.isnan(self._first).any(axis=1)).sum())
        enough = self._frames >= self.wanted and seen >= self.least
        return Stance(self._frames, seen, moved_m, mover, enough)

    def _moved(self, points_m: Array) -> tuple[float, int | None]:
        """Distance of the frame's points from the first ones, and the furthest marker."""
        if self._named:
            away = np.nan_to_num(np.linalg.norm(points_m - self._first, axis=1))
            return float(away.max()), int(away.argmax())
        away = np.sqrt(squared_distances(points_m, self._first).min(axis=1))
        return float(np.quantile(away, 1.0 - STRAY, method="lower")), None


def watched_names(names: Sequence[str], protocol: Protocol | None) -> tuple[str, ...]:
    """Names of a stream's markers that have to stay still: those that a protocol knows, all where no protocol does.

    Others may be tools; scaling judges by the frames whether they belong to the person.

    Args:
        names: The stream's.
        protocol: The protocol; by default the one the names belong to.
    """
    try:
        known = (protocol or detect_protocol(names)).match(names)
    except UnknownName:
        known = {}
    return tuple(name for name in names if name in known) or tuple(names)


def plates_mass_kg(plates: Sequence[PlateReadings]) -> float:
    """Mass of a person standing still on plates: the mean vertical force on the loaded ones, over gravity.

    Raises:
        NotObservable: The plates are not loaded by a person.
    """
    upwards = [(float(_mean_wrench(plate)[2]), plate.threshold_n) for plate in plates]
    mass_kg = sum(force for force, threshold in upwards if force > threshold) / GRAVITY_M_S2
    if mass_kg < LIGHTEST_KG:
        raise NotObservable(
            f"the plates carry {mass_kg:.1f} kg; stand on them with both feet, or give --mass KG"
        )
    return mass_kg


def scale_standing(
    capture: Capture,
    *,
    mass_kg: float | None = None,
    protocol: Protocol | None = None,
) -> Subject:
    """Scales the person who stands still in a capture, as :func:`mbkf.trial.scale.scale` does from a static trial.

    Args:
        capture: Frames of standing; points without names are named by the protocol first.
        mass_kg: Body mass; by default what the plates carry.
        protocol: The markers worn; where they have names, by default the one the names belong to.

    Raises:
        InvalidInput: The mass is not possible, or a protocol is missing for points without names.
        UnknownName: No protocol knows the markers.
        NotObservable: Too few markers; a sitting or kneeling person; or, without a mass, feet beside the plates.
        NotConverged: The markers do not fit a person.
    """
    mass = plates_mass_kg(capture.plates) if mass_kg is None else mass_kg
    if not capture.markers.names or all(name.startswith("*") for name in capture.markers.names):
        if protocol is None:
            raise InvalidInput("the points have no names; give --protocol NAME")
        found, _ = label_unscaled(capture, protocol, mass_kg=mass)
        capture = replace(capture, markers=found.markers)
    subject = scale(capture, mass_kg=mass, protocol=protocol)
    with single_threaded():
        model, q = _posture(capture, subject)
        _require_straight_legs(model, q)
        if mass_kg is None:
            _require_feet_on_plates(model, q, capture.plates)
    return under_names_of_static(subject)


def _posture(capture: Capture, subject: Subject) -> tuple[HumanModel, Array]:
    """The person's body, and its pose (nq,) in the frame that shows most markers."""
    shown = markers_as_scaled(capture.markers, subject)
    own = [marker for name in shown.names for marker in subject.markers if marker.name == name]
    model = HumanModel.of(subject)
    sensor = subject_sensor(model, own)
    best = shown.positions_m[shown.present.sum(axis=1).argmax()]
    noise_m = np.array([marker.noise_m for marker in own])
    first = segment_by_segment(sensor, best)
    return model, fit_pose(sensor, PostureSensor(model), best, noise_m, first).q


def _require_straight_legs(model: HumanModel, q: Array) -> None:
    """Refuses a sitting or kneeling person: scaling expects the neutral posture.

    Raises:
        NotObservable: A hip or knee is bent further than in standing.
    """
    clinical = ClinicalAngles(model)
    angles = dict(zip(clinical.names, np.degrees(clinical.angles(q[None])[0]), strict=True))
    name, bent = max(((name, abs(angles[name])) for name in BENDING), key=lambda one: one[1])
    if bent > MOST_BENT_DEG:
        raise NotObservable(f"the person is still, but does not stand ({name} is {bent:.0f}°); stand upright")


def _require_feet_on_plates(model: HumanModel, q: Array, plates: Sequence[PlateReadings]) -> None:
    """Refuses a weight of which the floor beside the plates carries a part.

    Raises:
        NotObservable: A foot is on no loaded plate.
    """
    feet = ContactDetector(model, plates, STILL_S)
    wrench = np.array([_mean_wrench(plate) for plate in plates])
    still = np.zeros(model.nv)
    contacts = feet.decide(feet.begin(), q, still, still, wrench).contacts
    beside = [side for side, on in zip(("right", "left"), contacts, strict=True) if on not in ON_PLATE]
    if beside:
        raise NotObservable(
            f"the {' and the '.join(beside)} foot is on no plate, so the plates do not carry the whole mass; stand on "
            "them with both feet, or give --mass KG"
        )


def _mean_wrench(plate: PlateReadings) -> Array:
    """(6,) mean force N and moment N m about the world's origin; NaN where nothing was read."""
    read = np.hstack([plate.force_n, plate.moment_nm])
    read = read[~np.isnan(read).any(axis=1)]
    mean = read.mean(axis=0) if len(read) else np.full(6, np.nan)
    mean[3:] += np.cross(plate.origin_m, mean[:3])
    return np.asarray(mean)
