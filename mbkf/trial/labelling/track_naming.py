"""Names of a capture's tracks and the person that they fit, from the protocol alone.

A body of the protocol's own geometry is matched with the tracks, the person is scaled from the names that this gives,
and the tracks are named anew by the scaled person, in turns. Where the protocol lists markers that are not worn, a
track may end with a neighbour's name, since scaling puts the marker where the track is. Names are therefore finally
judged by the cost of the person scaled from them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import NotConverged, NotObservable
from mbkf.io.records import Capture, MarkerTrajectories
from mbkf.io.subject import Subject
from mbkf.labelling.assignment import HIDDEN, Indices
from mbkf.labelling.keyframes import LOOKS, moving
from mbkf.labelling.naming import name_tracks, trajectories
from mbkf.labelling.tracks import Tracks
from mbkf.model.human import HumanModel
from mbkf.model.protocol import Protocol
from mbkf.numerics.runs import spread_indices
from mbkf.scaling.fit import scale_subject
from mbkf.scaling.naming import Naming, NamingProblem
from mbkf.scaling.records import ScalingSettings
from mbkf.scaling.renaming import likeliest, settled_names
from mbkf.sensors.marker_sensor import MarkerSensor
from mbkf.sensors.pose_fit import fit_pose, segment_by_segment
from mbkf.sensors.posture_sensor import PostureSensor
from mbkf.trial.labelling.any_attitude import name_tracks_of_frame
from mbkf.trial.labelling.doubts import Doubts, doubts
from mbkf.trial.labelling.starts import Start

ANCHORS = (0.35, 0.65, 0.05, 0.95)
"""Parts of the capture at which a body is matched with the tracks; persons are scaled from the likeliest bodies first,
until two outcomes agree, and the likeliest person is kept."""

SIZES = (0.85, 1.0, 1.15)
"""Sizes of the reference body that are tried without a height."""

ROUGH_M, ROUGH_RAD = 0.025, 0.15
"""Spread of a marker about the protocol's place before scaling, and of the tilt of a cluster."""

ROUNDS = 4
"""Greatest number of rounds of alternately scaling and naming."""

SCALING_FRAMES = 20
"""Frames from which a person is scaled in each round."""

RENAMINGS = 3
"""Greatest number of times that names are judged by the scaled person, and the tracks named anew."""

SEEN_SD_M = 0.015
"""Greatest spread of a marker about its place in scaling."""

SAME_RATIO = 0.99
"""Two outcomes agree with equal names and, of the smaller log ratio, at least this share of the other's."""

LEAST_NAMED = 0.6
"""Least share of the protocol's markers that is found."""


@dataclass(frozen=True)
class NamedTracks:
    """A person and the names of the tracks.

    Attributes:
        subject: The person.
        owner: (count,) marker of each track, ``HIDDEN`` where none.
        log_ratio: Log-likelihood ratio of the names.
        doubts: Names that may be others.
    """

    subject: Subject
    owner: Indices
    log_ratio: float
    doubts: Doubts | None = None


class TrackNaming:
    """The search for the person and the markers that explain the tracks of a capture.

    Args:
        capture: The capture.
        tracks: Its tracks.
        protocol: The markers that were worn.
        mass_kg: Body mass.
        height_m: Body height, if known.
    """

    def __init__(
        self, capture: Capture, tracks: Tracks, protocol: Protocol, mass_kg: float, height_m: float | None
    ) -> None:
        self._capture, self._tracks, self._protocol = capture, tracks, protocol
        self._mass_kg, self._height_m = mass_kg, height_m
        self._points_m = capture.markers.positions_m
        self._markers = tuple(marker for marker in protocol.markers if marker.kind != "computed")

    def best(self, progress: Callable[[int, int], None]) -> NamedTracks:
        """The likeliest names, from several parts of the capture.

        Raises:
            NotObservable: The tracks are not those of a person with these markers.
        """
        sizes = SIZES if self._height_m is None else (self._height_m / self._reference_height_m,)
        anchors = [round(share * (len(self._points_m) - 1)) for share in ANCHORS]
        searched, steps = [], 2 * len(anchors)
        for done, anchor in enumerate(anchors):
            progress(done, steps)
            searched.append(max((self._searched(anchor, size) for size in sizes), key=lambda one: one[1]))
        found: list[NamedTracks | None] = []
        for owner, _ in sorted(searched, key=lambda one: -one[1]):
            progress(len(anchors) + len(found), steps)
            one = self._scaled(owner)
            agreed = one is not None and any(_agree(one, other) for other in found)
            found.append(one)
            if agreed:
                break
        progress(steps, steps)
        good = [one for one in found if one is not None]
        if not good:
            raise NotObservable(
                f"the capture's tracks do not fit a person with the {len(self._markers)} markers of "
                f"'{self._protocol.name}'; check the marker set (--protocol), unit and axes (--unit, --up), and that"
                " the person moves; else scale a labelled trial first and give --subject"
            )
        return max(good, key=lambda one: one.log_ratio)

    def judged(self, named: NamedTracks, progress: Callable[[int, int], None]) -> NamedTracks:
        """The likeliest names by the cost of the person scaled from them, with those that may be others."""
        for _ in range(RENAMINGS):
            problem = self._problem(named.owner)
            found = likeliest(problem, progress)
            owner = _renamed(named.owner, problem, found.naming)
            again = None if (owner == named.owner).all() else self._settled(owner)
            if again is None:
                break
            named = again
        else:
            named = replace(named, owner=owner, subject=self._subject(owner))
        return replace(named, doubts=doubts(problem, found, self._nameless(named.owner)))

    def start(self, named: NamedTracks) -> Start:
        """The frame that shows most named markers, and the pose there."""
        shown = trajectories(self._points_m, self._tracks, named.owner, len(self._markers))
        frame = int((~np.isnan(shown[:, :, 0])).sum(axis=1).argmax())
        sensor = self._sensor(named.subject)
        first = segment_by_segment(sensor, shown[frame])
        posture = PostureSensor(sensor.model)
        return Start(frame, fit_pose(sensor, posture, shown[frame], self._spread(named.subject), first).q)

    @property
    def _reference_height_m(self) -> float:
        return self._protocol.body.reference_height_m

    def _searched(self, frame: int, size: float) -> tuple[Indices, float]:
        """(count,) marker of every track by a body of one size matched with them at a frame, and its score."""
        body = self._protocol.body
        factors = {name: size for name in body.scale_factors}
        model = HumanModel.scaled(factors, self._mass_kg, body)
        local = size * np.array([marker.position_m for marker in self._markers])
        sensor = MarkerSensor(model, [marker.segment for marker in self._markers], local)
        return name_tracks_of_frame(sensor, _rough_sd(sensor), self._points_m, self._tracks, frame)

    def _scaled(self, owner: Indices) -> NamedTracks | None:
        """Person and names that agree, from first names (count,); None where they do not fit a person."""
        named = self._settled(owner)
        if named is None:
            return None
        problem = self._problem(named.owner)
        owner = _renamed(named.owner, problem, settled_names(problem))
        return named if (owner == named.owner).all() else self._settled(owner)

    def _nameless(self, owner: Indices) -> int:
        """Number of tracks without a name that are seen in half of the frames, and move where most do."""
        lives, looks = self._tracks.visible(), spread_indices(len(self._points_m), LOOKS)
        moves = moving(self._tracks.positions(self._points_m, looks))
        return int(((owner == HIDDEN) & (lives.mean(axis=1) >= 0.5) & moves).sum())

    def _problem(self, owner: Indices) -> NamingProblem:
        return NamingProblem(self._shown(owner), self._protocol, height_m=self._height_m)

    def _settled(self, owner: Indices) -> NamedTracks | None:
        """Person and names after scaling and naming in turns, from first names (count,); None without a fit."""
        named = None
        for _ in range(ROUNDS):
            try:
                subject = self._subject(owner)
            except (NotConverged, NotObservable):
                return None
            again, log_ratio = name_tracks(
                self._sensor(subject), self._spread(subject), self._points_m, self._tracks, owner
            )
            named = NamedTracks(subject, again, log_ratio)
            if (again == owner).all():
                break
            owner = again
        assert named is not None
        found = len(np.unique(named.owner[named.owner != HIDDEN]))
        return named if found >= LEAST_NAMED * len(self._markers) else None

    def _subject(self, owner: Indices) -> Subject:
        return scale_subject(
            [],
            [self._shown(owner)],
            self._protocol,
            mass_kg=self._mass_kg,
            height_m=self._height_m,
            settings=ScalingSettings(frames_per_trial=SCALING_FRAMES, skin=False),
        )

    def _shown(self, owner: Indices) -> MarkerTrajectories:
        """Trajectories of all markers under names (count,) of the tracks."""
        names = tuple(marker.name for marker in self._markers)
        shown = trajectories(self._points_m, self._tracks, owner, len(names))
        return replace(self._capture.markers, names=names, positions_m=shown)

    def _sensor(self, subject: Subject) -> MarkerSensor:
        model = HumanModel.of(subject)
        return MarkerSensor(
            model,
            [marker.segment for marker in subject.markers],
            np.array([marker.position_m for marker in subject.markers]),
        )

    def _spread(self, subject: Subject) -> Array:
        """(M,) spread of each marker about its place: small where scaling saw it."""
        seen = subject.scaled_markers or ()
        return np.array(
            [
                np.hypot(m.noise_m, min(m.session_sd_m, SEEN_SD_M) if m.name in seen else m.session_sd_m)
                for m in subject.markers
            ]
        )


def _renamed(owner: Indices, problem: NamingProblem, naming: Naming) -> Indices:
    """(count,) names of the tracks, with the trajectories that were judged under their new names."""
    name = np.arange(len(problem.markers) + 1)  # the last is that of HIDDEN
    name[-1] = HIDDEN
    name[np.setdiff1d(naming.marker, problem.first)] = HIDDEN
    name[problem.first] = naming.marker
    return name[owner]


def _agree(one: NamedTracks, other: NamedTracks | None) -> bool:
    """True where all tracks named by both have the same names, and neither names many more."""
    if other is None:
        return False
    both = (one.owner != HIDDEN) & (other.owner != HIDDEN)
    same = bool((one.owner[both] == other.owner[both]).all())
    return same and min(one.log_ratio, other.log_ratio) >= SAME_RATIO * max(one.log_ratio, other.log_ratio)


def _rough_sd(sensor: MarkerSensor) -> Array:
    """(M,) spread of a marker about the protocol's place: the same for all, more at the ends of a tilted cluster."""
    segments = np.array(sensor.segments)
    spread = np.full(len(segments), ROUGH_M)
    for segment in set(sensor.segments):
        own = segments == segment
        arm = np.linalg.norm(sensor.local_m[own] - sensor.local_m[own].mean(axis=0), axis=1)
        spread[own] = np.hypot(ROUGH_M, ROUGH_RAD * arm)
    return spread
