"""Exchanged names of a named trial, corrected before it is used, and reported."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from mbkf.conventions import Array
from mbkf.io.limb_doubts import LimbDoubt
from mbkf.io.records import Capture, MarkerTrajectories
from mbkf.io.subject import Subject
from mbkf.labelling.exchanges import Distances, Exchange, body_distances, find_exchanges, undo_exchanges
from mbkf.labelling.turned_segments import find_turned
from mbkf.model.human import HumanModel
from mbkf.model.protocol import Protocol, ProtocolMarker
from mbkf.numerics.percentiles import known_percentiles
from mbkf.sensors.marker_sensor import MarkerSensor
from mbkf.trial.preparation.exchanged_sides import crosses, exchanged_by_pose
from mbkf.trial.preparation.static_names import carried_pairs, exchanged_names

STANDING_SD_M = 0.008
"""Spread of a marker about its place in the standing trial."""

EXCHANGED_KEY = "names_exchanged"
"""Key of a subject's report for names that trials exchange: ``[a, b, frames]`` by pair."""


def names_put_right(
    markers: MarkerTrajectories, subject: Subject
) -> tuple[MarkerTrajectories, tuple[tuple[str, str, int], ...]]:
    """A trial's trajectories with exchanged names put right by the subject's geometry, and the exchanges.

    Args:
        markers: (T, M, 3) m, under the subject's own names.
        subject: The scaled person.
    """
    carried = carried_pairs(markers, subject)
    markers = exchanged_names(markers, carried)
    by_name = {marker.name: marker for marker in subject.markers}
    own = [by_name[name] for name in markers.names]
    sensor = MarkerSensor(
        HumanModel.of(subject), [m.segment for m in own], np.array([m.position_m for m in own])
    )
    placed = np.array([np.hypot(m.noise_m, m.session_sd_m) for m in own])
    neutral = sensor.positions(sensor.model.neutral())
    distances = body_distances(sensor, placed)
    found = _found(markers.positions_m, sensor, neutral, distances)
    if crosses(found, sensor.segments):
        noise_m = np.array([m.noise_m for m in own])
        by_pose = exchanged_by_pose(markers.positions_m, sensor, noise_m, 1.0 / markers.rate_hz)
        if by_pose:
            right = undo_exchanges(markers.positions_m, by_pose)
            found = (*by_pose, *_found(right, sensor, neutral, distances))
    as_static = tuple((a, b, markers.frames) for a, b in carried)
    return _changed(markers, found), (*as_static, *_exchanges(markers, found))


def renamed_by_filter(
    markers: MarkerTrajectories, doubts: Sequence[LimbDoubt]
) -> tuple[MarkerTrajectories, tuple[tuple[str, str, int], ...]]:
    """A trial's trajectories under the names that a filter took up, and these exchanges.

    Args:
        markers: (T, M, 3) m, as the filter was given them.
        doubts: Doubts about limbs, times in s since the first frame.
    """
    since = np.arange(markers.frames) / markers.rate_hz
    found = tuple(
        Exchange(
            markers.names.index(a), markers.names.index(b), since >= one.right_from_s - 0.5 / markers.rate_hz
        )
        for one in doubts
        for a, b in one.exchanged
        if one.right_from_s is not None
    )
    return _changed(markers, found), _exchanges(markers, found)


def trials_put_right(
    static: MarkerTrajectories, trials: Sequence[Capture], protocol: Protocol
) -> tuple[list[Capture], tuple[tuple[str, str, int], ...]]:
    """Trials with exchanged names put right by distances as the standing trial has them, and the exchanges.

    Only markers that the standing trial shows take part: of a person not scaled yet, nothing else is known.

    Args:
        static: The standing trial.
        trials: The trials, under any names of the protocol.
        protocol: The markers worn.
    """
    model = HumanModel.scaled(body=protocol.body)
    stood = dict[
        tuple[str, ...], tuple[MarkerSensor, Array, Distances]
    ]()  # by markers, mostly those of all trials
    standing = {marker.name: name for name, marker in protocol.match(static.names).items()}
    there = np.asarray(static.present.any(axis=0))
    right: list[Capture] = []
    exchanges: list[tuple[str, str, int]] = []
    for trial in trials:
        match = {
            name: marker
            for name, marker in protocol.match(trial.markers.names).items()
            if marker.kind != "computed"
            and marker.name in standing
            and there[static.names.index(standing[marker.name])]
        }
        own = trial.markers.select(tuple(match))
        worn = tuple(marker.name for marker in match.values())
        if match and worn not in stood:
            columns = [static.names.index(standing[name]) for name in worn]
            stood[worn] = _as_stood(model, tuple(match.values()), static.positions_m[:, columns])
        found = _found(own.positions_m, *stood[worn]) if match else ()
        exchanges += _exchanges(own, found)
        fresh = _changed(own, found)
        positions = trial.markers.positions_m.copy()
        positions[:, [trial.markers.names.index(name) for name in own.names]] = fresh.positions_m
        right.append(
            replace(trial, markers=replace(trial.markers, positions_m=positions)) if found else trial
        )
    return right, tuple(exchanges)


def exchange_notes(found: Sequence[tuple[str, str, int]]) -> tuple[str, ...]:
    """One line about each pair."""
    return tuple(f"names {a} and {b} exchanged in {frames} frames, put right" for a, b, frames in found)


def _found(
    positions_m: Array, sensor: MarkerSensor, places_m: Array, distances: Distances
) -> tuple[Exchange, ...]:
    """Names permuted within segments, then pairs that are exchanged in some frames."""
    proximal = {one.name: one.parent for one in sensor.model.description.segments if one.parent}
    turned = find_turned(positions_m, places_m, sensor.segments, proximal)
    return (*turned, *find_exchanges(undo_exchanges(positions_m, turned), distances))


def _as_stood(
    model: HumanModel, markers: Sequence[ProtocolMarker], positions_m: Array
) -> tuple[MarkerSensor, Array, Distances]:
    """Markers of the reference body, their places (M, 3) and distances as a standing trial (T, M, 3) has them."""
    sensor = MarkerSensor(
        model, [marker.segment for marker in markers], np.array([marker.position_m for marker in markers])
    )
    return sensor, _middle(positions_m), _standing(positions_m, sensor)


def _middle(positions_m: Array) -> Array:
    """(M, 3) median place of each marker; NaN of a marker that is never seen."""
    return np.asarray(known_percentiles(positions_m, (50.0,))[0])


def _standing(positions_m: np.ndarray, sensor: MarkerSensor) -> Distances:
    """Distances as a standing trial has them, with the spread that movement brings."""
    body = body_distances(sensor, np.full(len(sensor.segments), STANDING_SD_M))
    first, second = np.triu_indices(len(sensor.segments), 1)
    apart = np.linalg.norm(positions_m[:, first] - positions_m[:, second], axis=2)
    median = known_percentiles(apart, (50.0,))[0]
    middle = body.expected_m.copy()
    middle[first, second] = middle[second, first] = np.where(
        np.isnan(median), body.expected_m[first, second], median
    )
    return Distances(middle, body.sd_m)


def _changed(markers: MarkerTrajectories, found: tuple[Exchange, ...]) -> MarkerTrajectories:
    return replace(markers, positions_m=undo_exchanges(markers.positions_m, found)) if found else markers


def _exchanges(markers: MarkerTrajectories, found: tuple[Exchange, ...]) -> tuple[tuple[str, str, int], ...]:
    return tuple((markers.names[one.a], markers.names[one.b], int(one.frames.sum())) for one in found)
