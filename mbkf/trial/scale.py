"""From captures to a scaled subject."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from mbkf.conventions import StageCallback
from mbkf.errors import InvalidInput, MbkfError, NotConverged, NotObservable
from mbkf.io.records import Capture
from mbkf.io.static_exchanges import STATIC_EXCHANGED_KEY
from mbkf.io.subject import Subject
from mbkf.marker_sets.parts import upper_body_only
from mbkf.model.body_file import load_body
from mbkf.model.description import BodyDescription
from mbkf.model.protocol import Protocol, load_protocol
from mbkf.numerics.threads import single_threaded
from mbkf.scaling.fit import scale_subject
from mbkf.scaling.records import ScalingSettings
from mbkf.scaling.stature import stature_doubts
from mbkf.scaling.verdict import APPROXIMATED_KEY, DOUBTS_KEY
from mbkf.trial.axes.captures import REPORT_KEY, checked_for_protocol, corrected_axes
from mbkf.trial.checks.unscaled_mass import PLATES_KEY, plate_notes, stated_mass_notes
from mbkf.trial.persons import check_one_person
from mbkf.trial.preparation.coverage import INFERRED_KEY, USE_KEY, MarkerUse, use_by_protocol
from mbkf.trial.preparation.exchanged import EXCHANGED_KEY, trials_put_right
from mbkf.trial.preparation.in_view import others_in_view
from mbkf.trial.preparation.static_names import Pairs, static_put_right, trials_as_static
from mbkf.trial.protocol.choice import ChosenSet, choose_marker_set, inferred_choice

EXPECTED = 4.0
"""RMS distance of the markers, over their noise, above which the names may belong to other markers."""

BETTER = 0.7
"""Greatest RMS distance of an inferred marker set, as a share of the shipped one's, with which it is used instead."""


def scale(
    static: Capture | None = None,
    trials: Sequence[Capture] = (),
    *,
    mass_kg: float | None = None,
    height_m: float | None = None,
    protocol: str | Protocol | None = None,
    body: str | Path | BodyDescription | None = None,
    settings: ScalingSettings | None = None,
    progress: StageCallback | None = None,
) -> Subject:
    """Fits the body to a person.

    Args:
        static: A standing trial, if there is one.
        trials: Trials of any movement.
        mass_kg: Body mass; by default what the captures state.
        height_m: Body height, if known.
        protocol: Protocol, its name or its file; by default the shipped one that the marker names belong to, else one
            inferred from the captures.
        body: The reference body: its name, a file of your own, or what :func:`mbkf.load_body` read; by default the one
            the protocol was written for. Markers of segments that it lacks are left out.
        settings: Weights of the priors.
        progress: Called with the stage, items done and items in all.

    Raises:
        InvalidInput: No trial, markers of several persons, no mass, an impossible mass or height, a protocol placed on
            another body, or axes or a unit that contradict the body.
        UnknownName: The protocol or body does not exist, or it names unknown segments.
        FileFormatError: The body's or the protocol's file is missing or damaged.
        NotObservable: Too few markers of the protocol, or markers without a protocol among which no body is found.
        NotConverged: The markers do not fit a body.
    """
    captures = ([] if static is None else [static]) + list(trials)
    if not captures:
        raise InvalidInput("scaling needs captures: a static trial, or at least one --trial")
    for capture in captures:
        check_one_person(capture)
    if mass_kg is None:
        mass_kg = next((c.subject_mass_kg for c in captures if c.subject_mass_kg is not None), None)
    if mass_kg is None:
        raise InvalidInput("the captures do not state the body mass; give --mass KG")
    if isinstance(body, str | Path):
        body = load_body(body)
    chosen = None
    if protocol is None:
        chosen = choose_marker_set(static, trials, body)
    elif isinstance(protocol, str):
        protocol = load_protocol(protocol, body)
    elif body is not None and (protocol.body.name, protocol.body.text) != (body.name, body.text):
        raise InvalidInput(
            f"the protocol '{protocol.name}' is placed on the body '{protocol.body.name}', not on '{body.name}'; "
            "read it with load_protocol(name, body)"
        )
    report = None if progress is None else lambda done, total: progress("Scaling", done, total)

    def scaled(by: ChosenSet) -> Subject:
        return _scaled(static is not None, captures, by, mass_kg, height_m, settings, report)

    if chosen is None:
        assert isinstance(protocol, Protocol)
        return scaled(ChosenSet(protocol, tuple(captures)))
    if not chosen.shipped:
        return scaled(chosen)
    return _better(scaled, chosen, lambda: inferred_choice(static, trials, body))


def _better(
    scaled: Callable[[ChosenSet], Subject], shipped: ChosenSet, inferred: Callable[[], ChosenSet]
) -> Subject:
    """The person scaled by a shipped protocol, or by an inferred set where that fits clearly better."""
    subject, refused = None, None
    try:
        subject = scaled(shipped)
    except (NotConverged, NotObservable) as error:
        refused = error
    expected = EXPECTED * float(np.median([marker.noise_m for marker in shipped.protocol.markers]))
    if subject is not None and _rms_m(subject) <= expected:
        return subject
    try:
        other = scaled(inferred())
    except MbkfError:
        other = None
    if other is not None and (subject is None or _rms_m(other) < BETTER * _rms_m(subject)):
        return other
    if subject is None:
        assert refused is not None
        raise refused
    return subject


def _rms_m(subject: Subject) -> float:
    rms = subject.report["marker_rms_mm"]
    assert isinstance(rms, float)
    return rms / 1e3


def _scaled(
    standing: bool,
    captures: Sequence[Capture],
    chosen: ChosenSet,
    mass_kg: float,
    height_m: float | None,
    settings: ScalingSettings | None,
    progress: Callable[[int, int], None] | None,
) -> Subject:
    """The person scaled by a marker set; the report also holds the use of the markers, axes and exchanged names."""
    protocol = chosen.protocol
    use = use_by_protocol([one.markers for one in captures], protocol)
    first = 1 if standing else 0
    checked = checked_for_protocol(chosen.captures, protocol, standing=first)
    exchanged = chosen.exchanged
    of_static: Pairs = ()
    refusal: NotConverged | None = None
    with single_threaded():
        if standing and chosen.shipped and (settings or ScalingSettings()).correct_names:
            static = checked[0]
            try:
                static, of_static = static_put_right(static, protocol, settings)
            except NotConverged as error:
                refusal = error  # scaling may know better what is wrong: axes, unit, a sitting person
            trials, more = trials_as_static(static, checked[1:], protocol, of_static)
            exchanged = (*exchanged, *more)
            checked = [static, *trials]
        if standing and len(checked) > 1:
            trials, more = trials_put_right(checked[0].markers, checked[1:], protocol)
            exchanged = (*exchanged, *more)
            checked = [checked[0], *trials]
        subject = scale_subject(
            [one.markers for one in checked[:first]],
            [one.markers for one in checked[first:]],
            protocol,
            mass_kg=mass_kg,
            height_m=height_m,
            settings=settings,
            progress=progress,
        )
    if refusal is not None:
        raise refusal
    contradictions = [*stated_mass_notes(checked, mass_kg), *plate_notes(checked, mass_kg)]
    axes = corrected_axes(captures, checked)
    use = use.without(_rarely_seen(captures, protocol, subject))
    extra: dict[str, object] = {USE_KEY: use.as_report()}
    if contradictions:
        extra[PLATES_KEY] = contradictions
    if exchanged:
        extra[EXCHANGED_KEY] = [list(one) for one in exchanged]
    if of_static:
        extra[STATIC_EXCHANGED_KEY] = [list(pair) for pair in of_static]
    if axes:
        extra[REPORT_KEY] = axes
    doubts = [
        *_others_in_view(checked, use),
        *_upper_body(subject, protocol.body),
        *stature_doubts(height_m, subject, protocol.body),
    ]
    if doubts:
        before = subject.report.get(DOUBTS_KEY)
        extra[DOUBTS_KEY] = [*(before if isinstance(before, list) else ()), *doubts]
    if protocol.body.approximations:
        extra[APPROXIMATED_KEY] = [one.text for one in protocol.body.approximations]
    if chosen.inferred is not None:
        extra[INFERRED_KEY] = {"told": chosen.inferred.line, "doubtful": chosen.inferred.doubts}
    return replace(subject, report={**subject.report, **extra})


def _others_in_view(captures: Sequence[Capture], use: MarkerUse) -> list[str]:
    """A sentence on a second person in the captures."""
    found = [others_in_view(one.markers, use.used) for one in captures]
    worst = max(found, key=lambda one: len(one.names))
    if not worst.is_person:
        return []
    return [f"{worst.sentence}: a second person is in view; scale from a capture of one"]


def _upper_body(subject: Subject, body: BodyDescription) -> list[str]:
    """A sentence on a person without markers on pelvis and legs; it names the body's own segments."""
    seen = subject.report["markers"]
    assert isinstance(seen, dict)
    counts = Counter(one.segment for one in subject.markers if one.name in seen)
    upper = upper_body_only(counts, body.roles)
    if not upper:
        return []
    return [
        f"markers are on {', '.join(upper)} alone; pelvis, legs and feet keep the reference body's proportions: add "
        "markers there"
    ]


def _rarely_seen(captures: Sequence[Capture], protocol: Protocol, subject: Subject) -> dict[str, str]:
    """The reason by each name of the captures whose marker scaling saw too rarely to place it."""
    left_out = subject.report["left_out"]
    assert isinstance(left_out, dict)
    matches = [protocol.match(one.markers.names) for one in captures]
    return {
        name: left_out[marker.name]
        for match in matches
        for name, marker in match.items()
        if marker.name in left_out
    }
