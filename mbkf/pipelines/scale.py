"""From captures to a scaled subject."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from mbkf.conventions import StageCallback
from mbkf.errors import InvalidInput
from mbkf.io.records import Capture
from mbkf.io.subject import Subject
from mbkf.model.body_file import load_body
from mbkf.model.description import BodyDescription
from mbkf.model.protocol import Protocol, detect_protocol, load_protocol
from mbkf.numerics.threads import single_threaded
from mbkf.pipelines.axes.captures import REPORT_KEY, checked_for_protocol, told_axes
from mbkf.pipelines.coverage import USE_KEY, require_coverage, use_by_protocol
from mbkf.scaling.fit import scale_subject
from mbkf.scaling.problem import ScalingSettings


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
        protocol: Protocol, its name or its file; by default the one the marker names belong to.
        body: The reference body: its name, a file of your own, or what :func:`mbkf.load_body` read; by default the one
            the protocol was written for. Markers of segments it does not have are left out.
        settings: Weights of the priors.
        progress: Called with the stage, items done and items in all.

    Raises:
        InvalidInput: No trial, no mass, a mass or height that cannot be, a protocol placed on another body, axes or a
            unit that cannot be right, or no protocol given and the nearest one knows too few of the markers.
        UnknownName: No protocol knows the markers, it names unknown segments, or there is no such body.
        FileFormatError: The body's or the protocol's file is missing or damaged.
        NotObservable: Too few markers of the protocol.
        NotConverged: The markers do not fit a person.
    """
    captures = ([] if static is None else [static]) + list(trials)
    if not captures:
        raise InvalidInput("scaling needs a static trial or at least one --trial")
    if mass_kg is None:
        mass_kg = next((c.subject_mass_kg for c in captures if c.subject_mass_kg is not None), None)
    if mass_kg is None:
        raise InvalidInput("the captures do not state the body mass; give --mass KG")
    if isinstance(body, str | Path):
        body = load_body(body)
    found = protocol is None
    if protocol is None:
        protocol = detect_protocol(captures[0].markers.names, body)
    elif isinstance(protocol, str):
        protocol = load_protocol(protocol, body)
    elif body is not None and (protocol.body.name, protocol.body.text) != (body.name, body.text):
        raise InvalidInput(
            f"the protocol '{protocol.name}' is placed on the body '{protocol.body.name}', not on '{body.name}'; "
            "read it with load_protocol(name, body)"
        )
    use = use_by_protocol([one.markers for one in captures], protocol)
    if found:
        require_coverage(use)
    report = None if progress is None else lambda done, total: progress("Scaling", done, total)
    checked = checked_for_protocol(captures, protocol)
    standing = [] if static is None else checked[:1]
    with single_threaded():
        subject = scale_subject(
            [one.markers for one in standing],
            [one.markers for one in checked[len(standing) :]],
            protocol,
            mass_kg=mass_kg,
            height_m=height_m,
            settings=settings,
            progress=report,
        )
    told = told_axes(captures, checked)
    use = use.without(_rarely_seen(captures, protocol, subject))
    extra = {USE_KEY: use.as_report(), **({REPORT_KEY: told} if told else {})}
    return replace(subject, report={**subject.report, **extra})


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
