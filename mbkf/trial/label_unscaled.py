"""Labels and a scaled subject from an unlabelled capture of a person not measured before, in any attitude."""

from __future__ import annotations

from dataclasses import replace

from mbkf.conventions import StageCallback
from mbkf.errors import InvalidInput
from mbkf.io.records import Capture
from mbkf.io.subject import Subject
from mbkf.labelling.tracks import link_tracks
from mbkf.model.protocol import Protocol, load_protocol
from mbkf.numerics.threads import single_threaded
from mbkf.trial.label import label
from mbkf.trial.labelling.any_attitude import STAGE
from mbkf.trial.labelling.result import Labelling
from mbkf.trial.labelling.track_naming import TrackNaming

NAMES = "Judging names"
"""Name of the last stage in progress reports."""


def label_unscaled(
    capture: Capture,
    protocol: Protocol | str,
    *,
    mass_kg: float | None = None,
    height_m: float | None = None,
    progress: StageCallback | None = None,
) -> tuple[Labelling, Subject]:
    """Names the points of a capture by the protocol alone, and scales the person.

    Args:
        capture: Unlabelled points; names are ignored, columns may be tracks or shuffled in every frame.
        protocol: The markers that were worn, a protocol or its name.
        mass_kg: Body mass; by default what the capture states.
        height_m: Body height, if known.
        progress: Called with the stage, items done and items in all.

    Raises:
        InvalidInput: No mass, or an impossible mass or height.
        UnknownName: The protocol does not exist.
        NotObservable: The points are not those of a moving person with the protocol's markers.
    """
    worn = load_protocol(protocol) if isinstance(protocol, str) else protocol
    report = progress or (lambda *_: None)
    mass = capture.subject_mass_kg if mass_kg is None else mass_kg
    if mass is None:
        raise InvalidInput("the capture does not state the body mass; give --mass KG")
    with single_threaded():
        tracks = link_tracks(capture.markers.positions_m, capture.markers.rate_hz)
        naming = TrackNaming(capture, tracks, worn, mass, height_m)
        best = naming.best(lambda done, total: report(STAGE, done, total))
        best = naming.judged(best, lambda done, total: report(NAMES, done, total))
        start = naming.start(best)
    found = label(capture, best.subject, start=start, ignore_names=True, progress=progress)
    return replace(found, doubts=best.doubts), best.subject
