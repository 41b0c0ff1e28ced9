"""Contents of a capture: markers and their gaps, plates and their offsets, channels, events, axes."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field

from mbkf.errors import InvalidInput, MbkfError, UnknownName
from mbkf.io.persons import several_persons
from mbkf.io.records import Capture, CaptureEvent, PlateReadings
from mbkf.model.protocol import detect_protocol
from mbkf.numerics.runs import runs
from mbkf.trial.axes.captures import find_axes_by_names
from mbkf.trial.axes.decision import AxesFinding, Verdict, applied
from mbkf.trial.checks.plate_contradictions import plate_contradictions
from mbkf.trial.checks.unscaled_mass import unscaled_mass_finding
from mbkf.trial.persons import PersonSummary, persons_in, summaries
from mbkf.trial.preparation.coverage import use_by_protocol
from mbkf.trial.protocol.choice import ChosenSet, choose_marker_set
from mbkf.trial.protocol.standing import stands_still


@dataclass(frozen=True)
class MarkerSummary:
    """Visibility of one marker.

    Attributes:
        name: Its name.
        missing_fraction: Share of frames in which it is missing, 0 to 1.
        pieces: Number of contiguous stretches in which it is seen.
    """

    name: str
    missing_fraction: float
    pieces: int


@dataclass(frozen=True)
class PlateSummary:
    """Recording of one force plate.

    Attributes:
        name: Its name.
        rate_hz: Sample rate in Hz.
        duration_s: Length of its recording in s.
        corners_m: Four world corners in m, or None where the file has no geometry.
        offset_n: Vertical force removed as offset, in N.
        loaded_fraction: Share of samples above the threshold, 0 to 1.
        peak_n: Largest vertical force in N.
        threshold_n: Vertical force in N from which the plate counts as loaded.
    """

    name: str
    rate_hz: float
    duration_s: float
    corners_m: tuple[tuple[float, ...], ...] | None
    offset_n: float
    loaded_fraction: float
    peak_n: float
    threshold_n: float


@dataclass(frozen=True)
class ChannelSummary:
    """One analog channel: name, unit, sample rate in Hz."""

    name: str
    unit: str
    rate_hz: float


@dataclass(frozen=True)
class AxesSummary:
    """Axes of a capture as read, and as the body in it shows them.

    Attributes:
        read: Axes of the file that were taken as forward, left and up.
        source: Source of that reading.
        verdict: "right", "put right", "kept", "unclear" (the person lies), "refused", "unknown" (too few markers with
            known names) or "given".
        used: Axes that the other commands would use.
        note: A sentence about it, "" where nothing was changed.
    """

    read: str
    source: str
    verdict: str
    used: str
    note: str


@dataclass(frozen=True)
class PlatesMass:
    """Mass by the plates, over stretches in which they carry the whole body.

    Attributes:
        kg: The mass, or None where such a stretch is too short.
        verdict: "inside", "doubtful" or "outside" against the mass that the file states, or a person's; else
            "not judged".
        note: A sentence about it.
    """

    kg: float | None
    verdict: str
    note: str


@dataclass(frozen=True)
class ProtocolSummary:
    """The marker set that `mbkf scale` would use, and the share of the capture's markers that it knows.

    Attributes:
        name: Its name.
        known: Number of markers that it knows.
        markers: Number of markers that have a name and were seen.
        share: The first over the second, 0 to 1.
        accepted: True where `mbkf scale` uses it by default.
        ignored: Reason why a marker is not used, by its name.
        told: Summary of an inferred set; "" for a shipped protocol.
        doubtful: Segments of every doubtful marker with their probabilities, of an inferred set.
    """

    name: str
    known: int
    markers: int
    share: float
    accepted: bool
    ignored: Mapping[str, str]
    told: str = ""
    doubtful: Mapping[str, list[tuple[str, float]]] = field(default_factory=dict)


@dataclass(frozen=True)
class CaptureSummary:
    """Contents of a capture.

    Attributes:
        path: The file.
        frames: Number of marker frames.
        rate_hz: Frame rate in Hz.
        start_time_s: Time of the first frame in s.
        duration_s: Frames divided by rate, in s.
        up_axis: Axis of the file that points up.
        length_unit: Length unit of the file.
        subject_mass_kg: Body mass the file states, or None.
        plates_mass: Mass by the plates; None without plates, or where the vertical is not known.
        plate_contradictions: A sentence on each contradiction of plates with their own area or the feet.
        labelled: Number of markers with a name of their own.
        unlabelled: Number of trajectories called ``*0``, ``*1`` ….
        missing_fraction: Share of missing samples over all markers, 0 to 1.
        extent_m: Lowest and highest x, y, z of all markers in m, in the axes that `mbkf scale` uses; None without
            markers.
        markers: Each marker.
        persons: Each of several persons, in the order of the file; empty for one.
        plates: Each force plate.
        derived: Number of derived points by kind.
        channels: Each analog channel.
        events: Labelled instants.
        notes: Remarks of the reader.
        axes: The axes as read, and as the body shows them.
        protocol: The marker set: a shipped protocol or an inferred one, else the protocol that knows most of the names;
            None without any, and for several persons.
        refusal: Reason why `mbkf scale` takes no marker set by itself, with the remedy; "" where it takes one.
    """

    path: str
    frames: int
    rate_hz: float
    start_time_s: float
    duration_s: float
    up_axis: str
    length_unit: str
    subject_mass_kg: float | None
    plates_mass: PlatesMass | None
    plate_contradictions: tuple[str, ...]
    labelled: int
    unlabelled: int
    missing_fraction: float
    extent_m: tuple[tuple[float, ...], tuple[float, ...]] | None
    markers: tuple[MarkerSummary, ...]
    persons: tuple[PersonSummary, ...]
    plates: tuple[PlateSummary, ...]
    derived: Mapping[str, int]
    channels: tuple[ChannelSummary, ...]
    events: tuple[CaptureEvent, ...]
    notes: tuple[str, ...]
    axes: AxesSummary
    protocol: ProtocolSummary | None
    refusal: str


def describe(capture: Capture) -> CaptureSummary:
    """Counts, shares and ranges of a capture."""
    markers = capture.markers
    present = markers.present
    unlabelled = sum(name.startswith("*") for name in markers.names)
    axes = find_axes_by_names(capture)
    found = _marker_set(capture)
    upright = _upright(capture, axes, found)
    persons = persons_in(upright)
    seen = upright.markers.positions_m[present]
    extent = (tuple(seen.min(axis=0).tolist()), tuple(seen.max(axis=0).tolist())) if len(seen) else None
    return CaptureSummary(
        path=capture.path,
        frames=markers.frames,
        rate_hz=markers.rate_hz,
        start_time_s=markers.start_time_s,
        duration_s=markers.frames / markers.rate_hz,
        up_axis=capture.up_axis,
        length_unit=capture.length_unit,
        subject_mass_kg=capture.subject_mass_kg,
        plates_mass=_plates_mass(upright),
        plate_contradictions=plate_contradictions(upright),
        labelled=len(markers.names) - unlabelled,
        unlabelled=unlabelled,
        missing_fraction=float(1.0 - present.mean()) if present.size else 0.0,
        extent_m=extent,
        markers=tuple(
            MarkerSummary(name, float(1.0 - column.mean()) if len(column) else 0.0, len(runs(column)))
            for name, column in zip(markers.names, present.T, strict=True)
        ),
        persons=summaries(upright, persons),
        plates=tuple(_plate(plate) for plate in upright.plates),
        derived=dict(Counter(point.kind for point in capture.derived)),
        channels=tuple(ChannelSummary(c.name, c.unit, c.rate_hz) for c in capture.analog),
        events=capture.events,
        notes=capture.notes,
        axes=_axes(capture, axes, upright),
        protocol=None if persons else _protocol(capture, found),
        refusal=several_persons(persons) if persons else found if isinstance(found, str) else "",
    )


def _marker_set(capture: Capture) -> ChosenSet | str:
    """The marker set that `mbkf scale` would use, else why there is none."""
    still = stands_still(capture.markers)
    try:
        return choose_marker_set(capture if still else None, () if still else (capture,))
    except MbkfError as error:
        return str(error).removeprefix(f"{capture.path or 'capture'}: ")


def _protocol(capture: Capture, found: ChosenSet | str) -> ProtocolSummary | None:
    """The marker set that was found, else the protocol that knows most of the names."""
    line, doubts = "", {}
    if isinstance(found, ChosenSet):
        protocol = found.protocol
        if found.inferred is not None:
            line, doubts = found.inferred.line, found.inferred.doubts
    else:
        try:
            protocol = detect_protocol(capture.markers.names)
        except UnknownName:
            return None
    use = use_by_protocol([capture.markers], protocol)
    known = use.markers - len(use.unknown)
    if line and protocol.joined:
        line = f"{use.summary}; {line}"
    return ProtocolSummary(
        use.protocol, known, use.markers, use.share, use.accepted, dict(use.ignored), line, doubts
    )


def _upright(capture: Capture, axes: AxesFinding, found: ChosenSet | str) -> Capture:
    """The capture in the axes that other commands would use; as it is where they refuse it."""
    if isinstance(found, ChosenSet) and not found.shipped:
        return found.captures[0]
    try:
        return applied(capture, axes)
    except InvalidInput:
        return capture


def _plates_mass(capture: Capture) -> PlatesMass | None:
    """The mass by the plates of an upright capture."""
    if not capture.plates:
        return None
    try:
        found = unscaled_mass_finding(capture)
    except InvalidInput:
        return None
    return PlatesMass(found.better, found.verdict, found.hint)


def _axes(capture: Capture, found: AxesFinding, upright: Capture) -> AxesSummary:
    """The axes as read and as used; of an inferred set, as the body of that set shows them."""
    verdict, note = found.verdict, found.note
    if upright.axes != capture.axes and verdict is not Verdict.PUT_RIGHT:
        verdict, note = Verdict.PUT_RIGHT, upright.notes[-1]
    return AxesSummary(
        read=capture.axes,
        source=capture.axes_source.value,
        verdict=verdict.value,
        used=upright.axes,
        note=note,
    )


def _plate(plate: PlateReadings) -> PlateSummary:
    vertical = plate.force_n[:, 2]
    corners = plate.corners_m
    return PlateSummary(
        name=plate.name,
        rate_hz=plate.rate_hz,
        duration_s=len(vertical) / plate.rate_hz,
        corners_m=None if corners is None else tuple(tuple(corner) for corner in corners.tolist()),
        offset_n=float(plate.offset[2]),
        loaded_fraction=float((vertical >= plate.threshold_n).mean()) if len(vertical) else 0.0,
        peak_n=float(vertical.max()) if len(vertical) else 0.0,
        threshold_n=plate.threshold_n,
    )
