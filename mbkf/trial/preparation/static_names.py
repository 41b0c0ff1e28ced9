"""Exchanged names of a static trial: put right before scaling, and looked for in the trials that follow it.

A session's markers are mostly named by one rule, so that its trials carry the exchange of the static. Poses fitted with
both namings decide: under wrong names joints leave their ranges, or markers their places.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import NotConverged
from mbkf.io.records import Capture, MarkerTrajectories
from mbkf.io.static_exchanges import STATIC_EXCHANGED_KEY, static_exchanges
from mbkf.io.subject import Subject
from mbkf.model.human import HumanModel
from mbkf.model.protocol import Protocol
from mbkf.numerics.runs import spread_indices
from mbkf.scaling.fit import scale_subject
from mbkf.scaling.records import ScalingSettings
from mbkf.scaling.standing_names import RANGE_SD_RAD, likeliest_names
from mbkf.sensors.marker_sensor import MarkerSensor
from mbkf.sensors.pose_fit import fit_pose, segment_by_segment
from mbkf.sensors.posture_sensor import PostureSensor
from mbkf.trial.preparation.selection import subject_markers

STATIC_FRAMES = 5
"""Frames of the static trial that give the body by which trials are judged."""

LOOKS = 6
"""Frames of a trial whose poses are fitted with both namings."""

LEAST_GAIN = 6.0
"""Least mean fall of a frame's cost for which a trial's names are exchanged as the static's are."""

MOST_MISFIT = 8.0
"""Cost per marker above which a static trial is refused. Clean ones have 0.5 to 3.1."""

Pairs = tuple[tuple[str, str], ...]


def static_put_right(
    static: Capture, protocol: Protocol, settings: ScalingSettings | None = None
) -> tuple[Capture, Pairs]:
    """A static trial with exchanged names put right, and the pairs of the protocol's names, one after the other.

    Args:
        static: The static trial, in the protocol's axes.
        protocol: The markers worn.
        settings: Weights of the priors.

    Raises:
        NotObservable: Too few markers of the protocol.
        NotConverged: The markers fit no standing person, and no exchange of names mends that.
    """
    found = likeliest_names(static.markers, protocol, settings)
    if found.misfit > MOST_MISFIT and not found.stray:
        raise NotConverged(
            f"the static trial's markers fit no one who stands: they cost {found.misfit:.0f} each, in right trials at "
            f"most 3, most of it {' and '.join(found.worst)}; check these names for an exchange, or keep all with "
            "--keep-names"
        )
    own = {marker.name: name for name, marker in protocol.match(static.markers.names).items()}
    pairs = [(own[a], own[b]) for a, b in found.exchanges]
    return replace(static, markers=exchanged_names(static.markers, pairs)), found.exchanges


def exchanged_names(markers: MarkerTrajectories, pairs: Sequence[tuple[str, str]]) -> MarkerTrajectories:
    """Trajectories with the names of pairs exchanged throughout, one pair after the other.

    Args:
        markers: The trajectories.
        pairs: Pairs of their names.
    """
    if not pairs:
        return markers
    order = np.arange(len(markers.names))
    for a, b in pairs:
        places = [markers.names.index(a), markers.names.index(b)]
        order[places] = order[places[::-1]]
    return replace(markers, positions_m=markers.positions_m[:, order])


def static_exchange_note(pairs: Sequence[tuple[str, str]]) -> str:
    """A sentence about the pairs that a static trial exchanged; "" without any.

    Args:
        pairs: The pairs.
    """
    if not pairs:
        return ""
    named = ", ".join(f"{a} and {b}" for a, b in pairs)
    return f"the static trial exchanges the names of {named}: put right by the fit of the body, a guess (--keep-names)"


def trials_as_static(
    static: Capture, trials: Sequence[Capture], protocol: Protocol, pairs: Pairs
) -> tuple[list[Capture], tuple[tuple[str, str, int], ...]]:
    """Trials with the pairs of the static trial exchanged where their poses say so, and these exchanges.

    Args:
        static: The static trial, names put right.
        trials: The trials, in the protocol's axes.
        protocol: The markers worn.
        pairs: Pairs of the protocol's names that the static trial exchanged.
    """
    if not pairs or not trials:
        return list(trials), ()
    few = ScalingSettings(frames_per_trial=STATIC_FRAMES)
    subject = scale_subject(
        [static.markers], [], protocol, mass_kg=protocol.body.reference_mass_kg, settings=few
    )
    subject = replace(subject, report={STATIC_EXCHANGED_KEY: [list(pair) for pair in pairs]})
    right, exchanges = list[Capture](), list[tuple[str, str, int]]()
    for trial in trials:
        found = carried_pairs(subject_markers(trial.markers, subject), subject)
        own = {marker.name: name for name, marker in protocol.match(trial.markers.names).items()}
        named = [(own[a], own[b]) for a, b in found]
        exchanges += [(a, b, trial.markers.frames) for a, b in named]
        right.append(replace(trial, markers=exchanged_names(trial.markers, named)) if named else trial)
    return right, tuple(exchanges)


def carried_pairs(markers: MarkerTrajectories, subject: Subject) -> Pairs:
    """The pairs of names that a trial exchanges as the static trial did, one after the other.

    Args:
        markers: (T, M, 3) m, under the subject's own names.
        subject: The scaled person, whose report has the pairs of the static trial.
    """
    known = tuple((a, b) for a, b in static_exchanges(subject) if a in markers.names and b in markers.names)
    if not known or not markers.frames:
        return ()
    poses = _Poses(markers, subject)
    costs = {one: poses.cost(exchanged_names(markers, one)) for one in dict.fromkeys(((), known))}
    if len(known) > 1 and len({name for pair in known for name in pair}) == 2 * len(known):
        costs.update((((pair),), poses.cost(exchanged_names(markers, (pair,)))) for pair in known)
    best = min(costs, key=lambda one: costs[one])
    return best if costs[best] < costs[()] - LEAST_GAIN else ()


def markers_as_scaled(markers: MarkerTrajectories, subject: Subject) -> MarkerTrajectories:
    """A capture's trajectories of the subject's markers, with the exchanges of the static trial that it carries undone.

    Args:
        markers: The capture's trajectories.
        subject: The scaled person.

    Raises:
        NotObservable: There are too few of the subject's markers.
    """
    own = subject_markers(markers, subject)
    return exchanged_names(own, carried_pairs(own, subject))


def under_names_of_static(subject: Subject) -> Subject:
    """The person with markers named as the static trial named them, for a stream that goes on from it.

    Args:
        subject: The scaled person.
    """
    known = [marker.name for marker in subject.markers]
    order = np.arange(len(known))
    for a, b in static_exchanges(subject):
        places = [known.index(a), known.index(b)]
        order[places] = order[places[::-1]]
    # marker m was found in the trajectory that order[m] names
    given = {name: subject.markers[k] for name, k in zip(known, order, strict=True)}
    markers = tuple(
        replace(one, name=given[one.name].name, aliases=given[one.name].aliases) for one in subject.markers
    )
    covariance = subject.covariance
    if covariance is not None:
        names = tuple(given[name].name if name in given else name for name in covariance.markers)
        covariance = replace(covariance, markers=names)
    return replace(subject, markers=markers, covariance=covariance)


class _Poses:
    """Poses of a few frames of a trial, fitted under names."""

    def __init__(self, markers: MarkerTrajectories, subject: Subject) -> None:
        by_name = {marker.name: marker for marker in subject.markers}
        own = [by_name[name] for name in markers.names]
        model = HumanModel.of(subject)
        self._sensor = MarkerSensor(model, [m.segment for m in own], np.array([m.position_m for m in own]))
        self._noise_m = np.array([np.hypot(m.noise_m, m.session_sd_m) for m in own])
        self._posture = PostureSensor(model)
        seen = markers.present.sum(axis=1)
        enough = np.flatnonzero(seen >= np.median(seen))
        self._frames = enough[spread_indices(len(enough), LOOKS)]

    def cost(self, markers: MarkerTrajectories) -> float:
        """Mean cost of a frame: markers, posture, and joints beyond their ranges."""
        shown = markers.positions_m[self._frames]
        starts = segment_by_segment(self._sensor, shown)
        return float(np.mean([self._of(frame, q) for frame, q in zip(shown, starts, strict=True)]))

    def _of(self, frame_m: Array, start: Array) -> float:
        q = fit_pose(self._sensor, self._posture, frame_m, self._noise_m, start).q
        errors = (self._sensor.positions(q) - frame_m) / self._noise_m[:, None]
        turned, limits = self._posture.deviation(q)[0], self._sensor.model.limits
        beyond = np.maximum(np.maximum(turned - limits[:, 1], limits[:, 0] - turned), 0.0)
        usual = turned * self._posture.weights(1.0, np.zeros(len(turned), dtype=bool))
        return float(np.nansum(errors**2) + usual @ usual + ((beyond / RANGE_SD_RAD) ** 2).sum())
