"""Coverage of a capture by its marker protocol: markers used, markers ignored, and the reasons."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from mbkf.io.records import MarkerTrajectories
from mbkf.io.subject import Named, Subject, match_names
from mbkf.model.protocol import Protocol, load_protocol, protocol_names
from mbkf.numerics.printed import percent

LEAST_SHARE = 0.6
"""A protocol that knows a smaller share of a capture's markers is probably not theirs, and never used in silence."""

MOST_NAMED = 8
"""Names that a line lists at most."""

USE_KEY = "marker_use"
"""Key of a subject's report for the markers of its captures."""

INFERRED_KEY = "inferred"
"""Key of a subject's report for an inferred marker set."""

UNKNOWN = "the protocol does not know it"
COMPUTED = "a computed point, read for scaling only"
NO_SEGMENT = "the body lacks its segment"
LEFT_OUT = "the protocol leaves it out"
TWICE = "another name of a marker that is there under its own"


@dataclass(frozen=True)
class MarkerUse:
    """Use of a capture's markers: of those that have a name of their own and were seen.

    Attributes:
        protocol: Name of the protocol.
        used: Names in the capture that are followed or scaled from.
        ignored: The reason by each other name.
        joined: Names that the protocol's file does not know, used or ignored by inference from the captures.
    """

    protocol: str
    used: tuple[str, ...]
    ignored: Mapping[str, str] = field(default_factory=dict)
    joined: tuple[str, ...] = ()

    @property
    def markers(self) -> int:
        """Number of markers that have a name and were seen."""
        return len(self.used) + len(self.ignored)

    @property
    def unknown(self) -> tuple[str, ...]:
        """Names that the protocol does not know."""
        return tuple(name for name, reason in self.ignored.items() if reason == UNKNOWN)

    @property
    def share(self) -> float:
        """Share of the markers that the protocol knows, used or not, 0 to 1; 1 without markers."""
        return 1.0 - len(self.unknown) / self.markers if self.markers else 1.0

    @property
    def accepted(self) -> bool:
        """True where it may be used by default: it knows enough of the markers."""
        return self.share >= LEAST_SHARE

    @property
    def summary(self) -> str:
        """The protocol's coverage, in words."""
        known = self.markers - len(self.unknown) - len(self.joined)
        share = known / self.markers if self.markers else 1.0
        others = f", {sum(name in self.used for name in self.joined)} more inferred" if self.joined else ""
        return f"{self.protocol} knows {known} of {self.markers} markers ({percent(share)}){others}"

    @property
    def warning(self) -> str:
        """A line about a protocol that knows too few of the markers, "" where it knows enough."""
        if self.share >= LEAST_SHARE:
            return ""
        return f"protocol {self.summary}; ignored are {listed(self.unknown)}"

    def without(self, reasons: Mapping[str, str]) -> MarkerUse:
        """The same with further markers that are not used after all.

        Args:
            reasons: The reason by name in the capture.
        """
        used = tuple(name for name in self.used if name not in reasons)
        further = {name: reason for name, reason in reasons.items() if name in self.used}
        return MarkerUse(self.protocol, used, {**self.ignored, **further}, self.joined)

    def as_report(self) -> dict[str, object]:
        """Plain data for a subject's report."""
        return {
            "markers": self.markers,
            "used": len(self.used),
            "share": round(self.share, 4),
            "told": self.summary,
            "warning": self.warning,
            "ignored": dict(self.ignored),
            "joined": list(self.joined),
        }


def listed(names: Collection[str]) -> str:
    """The first names of a list, and how many there are in all where it is longer."""
    first = ", ".join(tuple(names)[:MOST_NAMED])
    return f"{first} … ({len(names)} in all)" if len(names) > MOST_NAMED else first


def use_by_protocol(captures: Sequence[MarkerTrajectories], protocol: Protocol) -> MarkerUse:
    """Coverage of the markers of a person's captures by a protocol, each name counted once.

    Args:
        captures: Markers of the captures.
        protocol: The protocol.
    """
    matches = [protocol.match(one.names) for one in captures]
    names = dict.fromkeys(name for one in captures for name in _seen(one))
    used = tuple(name for name in names if any(name in match for match in matches))
    reasons = _ignored(names, used, protocol.markers, _cut_from(protocol))
    left_out = {n: reason or LEFT_OUT for n, reason in protocol.ignored.items() if n in reasons}
    joined = tuple(name for name in names if name in protocol.joined)
    return MarkerUse(protocol.name, used, {**reasons, **left_out}, joined)


def _cut_from(protocol: Protocol) -> str:
    """Name of the shipped protocol of which this one is a part, on another body; "" otherwise."""
    if protocol.name not in protocol_names():
        return ""
    body = load_protocol(protocol.name).body
    return "" if (body.name, body.text) == (protocol.body.name, protocol.body.text) else protocol.name


def use_by_subject(markers: MarkerTrajectories, subject: Subject) -> MarkerUse:
    """Use of a scaled person's markers in a trial.

    Args:
        markers: The trial's.
        subject: The person.
    """
    return _use(_seen(markers), match_names(markers.names, subject.markers), subject)


def use_of_names(names: tuple[str, ...], subject: Subject) -> MarkerUse:
    """Use of a scaled person's markers in a stream, in which any of its markers may appear at any time.

    Args:
        names: The stream's markers.
        subject: The person.
    """
    own = tuple(name for name in names if name[:1] != "*")
    return _use(own, match_names(names, subject.markers), subject)


def _use(names: Sequence[str], match: Collection[str], subject: Subject) -> MarkerUse:
    """Use of markers that have a name of their own.

    Args:
        names: Their names.
        match: Names that stand for one of the person's markers.
        subject: The person.
    """
    used = tuple(name for name in names if name in match)
    reasons = _ignored(names, used, subject.markers, subject.protocol)
    reasons.update({name: COMPUTED for name in reasons if name in _computed(subject)})
    reasons.update({name: reason for name, reason in _left_out(subject).items() if name in reasons})
    report = subject.report.get(USE_KEY)
    joined = report.get("joined", ()) if isinstance(report, dict) else ()
    return MarkerUse(subject.protocol, used, reasons, tuple(name for name in names if name in joined))


def _left_out(subject: Subject) -> dict[str, str]:
    """Markers left out of the person's set on purpose, with the reason."""
    use = subject.report.get(USE_KEY)
    ignored = use["ignored"] if isinstance(use, dict) else {}
    return {name: reason for name, reason in ignored.items() if reason not in (UNKNOWN, NO_SEGMENT, TWICE)}


def _computed(subject: Subject) -> set[str]:
    """Computed points that the person was scaled from, also those of a protocol that is not shipped."""
    scaled = subject.report.get("markers")
    entries = scaled.items() if isinstance(scaled, dict) else ()
    return {name for name, entry in entries if entry["kind"] == "computed"}


def _seen(markers: MarkerTrajectories) -> tuple[str, ...]:
    """Names of the markers that have one of their own and are seen in any frame."""
    seen = np.asarray(markers.present.any(axis=0))
    return tuple(name for name, there in zip(markers.names, seen, strict=True) if there and name[:1] != "*")


def _ignored(
    names: Iterable[str], used: Collection[str], own: Sequence[Named], protocol: str
) -> dict[str, str]:
    """The reason of every name that is not used.

    Args:
        names: Names in the capture.
        used: Those that are used.
        own: The markers that are looked for.
        protocol: The protocol's name; a shipped one also names markers that are not sought on this body.
    """
    others = {name for marker in own for name in (marker.name, *marker.aliases)}
    rest = [name for name in names if name not in used]
    whole = load_protocol(protocol).match(rest) if protocol in protocol_names() else {}
    reasons = {}
    for name in rest:
        if name in others:
            reasons[name] = TWICE
        elif name in whole:
            reasons[name] = COMPUTED if whole[name].kind == "computed" else NO_SEGMENT
        else:
            reasons[name] = UNKNOWN
    return reasons
