"""Labels and a scaled subject from an unlabelled capture of a person not measured before, in any attitude.

Neither can be had without the other, so both are found by turns: a body of the protocol's own geometry is matched with
the capture's tracks, the person is scaled from what that names, and the tracks are named anew by the scaled person.
Where the protocol lists markers that are not worn, such turns may end with a neighbour's name on a track: scaling puts
the marker where the track is. So names are then judged by what the person costs that goes with them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from mbkf.conventions import Array, StageCallback
from mbkf.errors import InvalidInput, NotConverged, NotObservable
from mbkf.io.records import Capture, MarkerTrajectories
from mbkf.io.subject import Subject
from mbkf.labelling.assignment import HIDDEN, Indices
from mbkf.labelling.keyframes import LOOKS, moving
from mbkf.labelling.naming import name_tracks, trajectories
from mbkf.labelling.tracks import Tracks, link_tracks
from mbkf.model.human import HumanModel
from mbkf.model.protocol import Protocol, load_protocol
from mbkf.numerics.runs import spread_indices
from mbkf.numerics.threads import single_threaded
from mbkf.scaling.fit import scale_subject
from mbkf.scaling.naming import Naming, NamingProblem
from mbkf.scaling.problem import ScalingSettings
from mbkf.scaling.renaming import in_line, likeliest
from mbkf.sensors.marker_sensor import MarkerSensor
from mbkf.sensors.pose_fit import fit_pose, segment_by_segment
from mbkf.sensors.posture_sensor import PostureSensor
from mbkf.trial.label import label
from mbkf.trial.labelling.any_attitude import STAGE, name_tracks_of_frame
from mbkf.trial.labelling.doubts import Doubts, doubts
from mbkf.trial.labelling.result import Labelling
from mbkf.trial.labelling.starts import Start

ANCHORS = (0.35, 0.65, 0.05, 0.95)
"""Where in the capture a body is matched with the tracks, until two outcomes agree; the likeliest is kept."""

SIZES = (0.85, 1.0, 1.15)
"""Sizes of the reference body that are tried where no height is given."""

ROUGH_M, ROUGH_RAD = 0.025, 0.15
"""How far a marker of a person not scaled yet is from the protocol's place, and how far a cluster may be tilted."""

ROUNDS = 4
"""Most iterations of scaling and labels."""

SCALING_FRAMES = 20
"""Frames that a person is scaled from in each round."""

RENAMINGS = 3
"""How often names are judged by the person that they make, and the tracks named anew, at most."""

SEEN_SD_M = 0.015
"""How far a marker is at most from where scaling found it."""

SAME_WORTH = 0.99
"""Two outcomes agree where they name alike and the lesser is worth so much of the other."""

NAMES = "Judging names"
"""Name of the last stage in progress reports."""

LEAST_NAMED = 0.6
"""Share of the protocol's markers that must be found."""


@dataclass(frozen=True)
class _Named:
    """A person and the tracks' names: ``owner`` (count,) the marker of each, ``worth`` how well all of it fits.

    ``doubts`` are names that may be others.
    """

    subject: Subject
    owner: Indices
    worth: float
    doubts: Doubts | None = None


def label_unscaled(
    capture: Capture,
    protocol: Protocol | str,
    *,
    mass_kg: float | None = None,
    height_m: float | None = None,
    progress: StageCallback | None = None,
) -> tuple[Labelling, Subject]:
    """Names the points of a capture by the protocol alone, and scales the person on the way.

    Args:
        capture: Unlabelled points; names are ignored, columns may be tracks or shuffled in every frame.
        protocol: The markers that were worn, a protocol or its name.
        mass_kg: Body mass; by default what the capture states.
        height_m: Body height, if known.
        progress: Called with the stage, items done and items in all.

    Raises:
        InvalidInput: No mass, or a mass or height that cannot be.
        UnknownName: There is no such protocol.
        NotObservable: The points are not those of a person who wears the protocol's markers and moves.
    """
    worn = load_protocol(protocol) if isinstance(protocol, str) else protocol
    report = progress or (lambda *_: None)
    mass = capture.subject_mass_kg if mass_kg is None else mass_kg
    if mass is None:
        raise InvalidInput("the capture does not state the body mass; give --mass KG")
    with single_threaded():
        tracks = link_tracks(capture.markers.positions_m, capture.markers.rate_hz)
        search = _Search(capture, tracks, worn, mass, height_m)
        best = search.best(lambda done, total: report(STAGE, done, total))
        best = search.settled(best, lambda done, total: report(NAMES, done, total))
        start = search.start(best)
    found = label(capture, best.subject, start=start, ignore_names=True, progress=progress)
    return replace(found, doubts=best.doubts), best.subject


class _Search:
    """The search for a person's markers among the tracks of a capture."""

    def __init__(
        self, capture: Capture, tracks: Tracks, protocol: Protocol, mass_kg: float, height_m: float | None
    ) -> None:
        self._capture, self._tracks, self._protocol = capture, tracks, protocol
        self._mass_kg, self._height_m = mass_kg, height_m
        self._points_m = capture.markers.positions_m
        self._markers = tuple(marker for marker in protocol.markers if marker.kind != "computed")

    def best(self, progress: Callable[[int, int], None]) -> _Named:
        """The likeliest outcome.

        Raises:
            NotObservable: There is none.
        """
        sizes = SIZES if self._height_m is None else (self._height_m / self._reference_height_m,)
        anchors = [round(share * (len(self._points_m) - 1)) for share in ANCHORS]
        found: list[_Named | None] = []
        for done, anchor in enumerate(anchors):
            progress(done, len(anchors))
            owner, _ = max((self._searched(anchor, size) for size in sizes), key=lambda one: one[1])
            one = self._scaled(owner)
            agreed = one is not None and any(_agree(one, other) for other in found)
            found.append(one)
            if agreed:
                break
        progress(len(anchors), len(anchors))
        good = [one for one in found if one is not None]
        if not good:
            raise NotObservable(
                f"nowhere do the capture's tracks make a person with the {len(self._markers)} markers of "
                f"'{self._protocol.name}'; is it this marker set (--protocol), does the person move, and are unit and "
                "axes right (--unit, --up)? Else scale a labelled trial first and give --subject"
            )
        return max(good, key=lambda one: one.worth)

    def settled(self, named: _Named, progress: Callable[[int, int], None]) -> _Named:
        """The likeliest labels by the person that they make, and those that may be others."""
        for _ in range(RENAMINGS):
            problem = self._problem(named.owner)
            found = likeliest(problem, progress)
            owner = _renamed(named.owner, problem, found.naming)
            again = None if (owner == named.owner).all() else self._in_line(owner)
            if again is None:
                break
            named = again
        else:
            named = replace(named, owner=owner, subject=self._subject(owner))
        return replace(named, doubts=doubts(problem, found, self._nameless(named.owner)))

    def start(self, named: _Named) -> Start:
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

    def _scaled(self, owner: Indices) -> _Named | None:
        """Person and labels brought into line, from first labels (count,); None where no person comes of them."""
        named = self._in_line(owner)
        if named is None:
            return None
        problem = self._problem(named.owner)
        owner = _renamed(named.owner, problem, in_line(problem))
        return named if (owner == named.owner).all() else self._in_line(owner)

    def _nameless(self, owner: Indices) -> int:
        """How many tracks without a label are seen in half of the frames, and move where most do."""
        lives, looks = self._tracks.visible(), spread_indices(len(self._points_m), LOOKS)
        moves = moving(self._tracks.positions(self._points_m, looks))
        return int(((owner == HIDDEN) & (lives.mean(axis=1) >= 0.5) & moves).sum())

    def _problem(self, owner: Indices) -> NamingProblem:
        return NamingProblem(self._shown(owner), self._protocol, height_m=self._height_m)

    def _in_line(self, owner: Indices) -> _Named | None:
        """Person and labels brought into line, from first labels (count,); None where no person comes of them."""
        named = None
        for _ in range(ROUNDS):
            try:
                subject = self._subject(owner)
            except (NotConverged, NotObservable):
                return None
            again, worth = name_tracks(
                self._sensor(subject), self._spread(subject), self._points_m, self._tracks, owner
            )
            named = _Named(subject, again, worth)
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
            settings=ScalingSettings(frames_per_trial=SCALING_FRAMES),
        )

    def _shown(self, owner: Indices) -> MarkerTrajectories:
        """Trajectories of all markers under labels (count,) of the tracks."""
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
        """(M,) how far each marker may be from its place: little where scaling saw it."""
        seen = subject.scaled_markers or ()
        return np.array(
            [
                np.hypot(m.noise_m, min(m.session_sd_m, SEEN_SD_M) if m.name in seen else m.session_sd_m)
                for m in subject.markers
            ]
        )


def _renamed(owner: Indices, problem: NamingProblem, naming: Naming) -> Indices:
    """(count,) labels of the tracks, with the trajectories that were judged under their new names."""
    name = np.arange(len(problem.markers) + 1)  # the last is that of HIDDEN
    name[-1] = HIDDEN
    name[np.setdiff1d(naming.marker, problem.first)] = HIDDEN
    name[problem.first] = naming.marker
    return name[owner]


def _agree(one: _Named, other: _Named | None) -> bool:
    """Whether all tracks that both name have the same names in both, and neither names many more."""
    if other is None:
        return False
    both = (one.owner != HIDDEN) & (other.owner != HIDDEN)
    same = bool((one.owner[both] == other.owner[both]).all())
    return same and min(one.worth, other.worth) >= SAME_WORTH * max(one.worth, other.worth)


def _rough_sd(sensor: MarkerSensor) -> Array:
    """(M,) how far a marker may be from the protocol's place: all alike, and further out on a tilted cluster."""
    segments = np.array(sensor.segments)
    spread = np.full(len(segments), ROUGH_M)
    for segment in set(sensor.segments):
        own = segments == segment
        arm = np.linalg.norm(sensor.local_m[own] - sensor.local_m[own].mean(axis=0), axis=1)
        spread[own] = np.hypot(ROUGH_M, ROUGH_RAD * arm)
    return spread
