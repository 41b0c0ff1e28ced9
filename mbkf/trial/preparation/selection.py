"""Parts of a capture that a reconstruction reads: the subject's markers, without hidden samples and withheld plates."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.errors import InvalidInput, NotObservable, UnknownName
from mbkf.io.persons import named_persons, several_persons
from mbkf.io.records import Capture, MarkerTrajectories
from mbkf.io.subject import Subject, match_names
from mbkf.scaling.frames import MIN_MARKERS
from mbkf.trial.preparation.settings import Hidden


def subject_markers(markers: MarkerTrajectories, subject: Subject) -> MarkerTrajectories:
    """The capture's trajectories of the subject's markers, under the subject's names.

    Raises:
        NotObservable: There are too few of them, or they are those of several persons.
    """
    found = match_names(markers.names, subject.markers)
    if not markers.names:
        raise NotObservable("the capture holds no markers; export it again with them, or leave it out")
    if len(found) < MIN_MARKERS and all(name.startswith("*") for name in markers.names):
        raise NotObservable("no marker of the capture has a name; name them with 'mbkf label'")
    if len(found) < MIN_MARKERS:
        if persons := named_persons(markers):
            raise NotObservable(several_persons(persons))
        raise NotObservable(
            f"the capture has {len(found)} of the subject's markers (protocol '{subject.protocol}'; "
            f"at least {MIN_MARKERS} are needed); its own are {', '.join(markers.names[:6]) or 'none'}: "
            "scale the person from a capture with these names, or correct --subject"
        )
    return replace(markers.select(tuple(found)), names=tuple(marker.name for marker in found.values()))


def hidden_samples(
    markers: MarkerTrajectories, hide: Sequence[Hidden], times_s: Array | None = None
) -> BoolArray:
    """(T, M) measured samples that are hidden on request.

    Args:
        markers: The subject's markers.
        hide: Markers to hide.
        times_s: (T,) times of the frames; None: those of the markers.

    Raises:
        InvalidInput: A time window ends before it begins.
        UnknownName: The subject has no marker of that name.
    """
    hidden = np.zeros(markers.present.shape, dtype=bool)
    times_s = markers.times_s if times_s is None else times_s
    for one in hide:
        if one.to_s < one.from_s:
            raise InvalidInput(f"--hide: the time window {one.from_s}:{one.to_s} ends before it begins")
        frames = (times_s >= one.from_s) & (times_s <= one.to_s)
        for name in one.names:
            if name not in markers.names:
                raise UnknownName("marker", name, markers.names, "--hide")
            hidden[frames, markers.names.index(name)] = True
    return hidden & markers.present


def without_samples(markers: MarkerTrajectories, hidden: BoolArray) -> MarkerTrajectories:
    """The markers with NaN where ``hidden`` (T, M) is true."""
    return replace(markers, positions_m=np.where(hidden[:, :, None], np.nan, markers.positions_m))


def plate_names(capture: Capture) -> tuple[str, ...]:
    """Names of the capture's plates, and of those that the reader left out."""
    return (*(plate.name for plate in capture.plates), *capture.plates_left_out)


def check_withheld(known: Collection[str], withheld: Collection[str]) -> None:
    """Refuses names of plates to withhold that are not among those known.

    Raises:
        UnknownName: There is such a name.
    """
    for name in withheld:
        if name not in known:
            raise UnknownName("plate", name, list(known) or ["(the capture has none)"], "--without-plate")


def without_plates(capture: Capture, withheld: Collection[str]) -> Capture:
    """The capture without the plates named; those that the reader left out may be named, too.

    Raises:
        UnknownName: The capture has no plate of that name.
    """
    check_withheld(plate_names(capture), withheld)
    return replace(capture, plates=tuple(plate for plate in capture.plates if plate.name not in withheld))
