"""A shipped marker set joined by the markers of a capture that it does not know.

The body is searched in the cloud of all markers. Those that the set knows count with its segment and landmark in place
of their names; the segments and places of the others follow as for an unknown set (:mod:`mbkf.marker_sets.inference`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from mbkf.io.records import Capture
from mbkf.marker_sets.inference import SURE, infer_markers
from mbkf.marker_sets.names import NamedPlace, NameReading, read_names
from mbkf.model.protocol import Protocol, ProtocolMarker
from mbkf.numerics.threads import single_threaded
from mbkf.trial.axes.captures import checked_for_protocol
from mbkf.trial.preparation.coverage import listed, use_by_protocol
from mbkf.trial.protocol.inferred import (
    LEAST_NAMED_LOG_ODDS,
    OFF_BODY,
    off_the_skin,
    protocol_markers,
    require_person,
    worn_markers,
)


@dataclass(frozen=True)
class JoinedSet:
    """A shipped marker set with further markers.

    Attributes:
        protocol: The set, with the further markers, and the points that are left out.
    """

    protocol: Protocol

    @property
    def markers(self) -> tuple[ProtocolMarker, ...]:
        """The markers that joined."""
        return tuple(one for one in self.protocol.markers if one.name in self.protocol.joined)

    @property
    def line(self) -> str:
        """Summary of the markers that joined and of those left out."""
        parts = []
        if self.markers:
            places = listed([f"{one.name} ({one.segment.replace('_', ' ')})" for one in self.markers])
            parts.append(f"joined to {self.protocol.name} by inference: {places}")
        if self.doubts:
            parts.append(f"{len(self.doubts)} doubtful: {listed(self.doubts)}")
        if self.protocol.ignored:
            parts.append(f"left out: {listed(self.protocol.ignored)}")
        return "; ".join(parts)

    @property
    def doubts(self) -> dict[str, list[tuple[str, float]]]:
        """Segments of every doubtful marker that joined, with their probabilities, likeliest first."""
        return {
            one.name: [(one.segment, round(one.probability, 2)), *one.alternatives]
            for one in self.markers
            if one.probability < SURE
        }


def with_others(
    shipped: Protocol, static: Capture | None, trials: Sequence[Capture], leave_out: Sequence[str] = ()
) -> JoinedSet | None:
    """A shipped set joined by the markers that it does not know, None where it knows all of them.

    Args:
        shipped: The set.
        static: A standing trial, if there is one.
        trials: Trials of any movement.
        leave_out: Shipped protocols whose places do not count, for tests on markers that they describe.

    Raises:
        InvalidInput: The axes of a capture contradict the body.
        NotObservable: Too few markers, or no body is found among them.
    """
    captures = [*([] if static is None else [static]), *trials]
    unknown = use_by_protocol([one.markers for one in captures], shipped).unknown
    if not unknown:
        return None
    names = tuple(dict.fromkeys(name for one in captures for name in one.markers.names))
    known = shipped.match(names)
    readings = read_names(names) | {
        name: NameReading(name, (NamedPlace(one.segment, one.landmark, 1.0),), _kind(one), "")
        for name, one in known.items()
    }
    off = {name: why for name, why in off_the_skin(captures, readings).items() if name in unknown}
    computed = {name for name, one in known.items() if one.kind == "computed"}
    strangers = set(unknown).difference(off)
    left_out, markers = dict(off), tuple[ProtocolMarker, ...]()
    if strangers:
        standing = 0 if static is None else 1
        with single_threaded():
            upright = checked_for_protocol(captures, shipped, standing=standing)
            worn = worn_markers(upright, {*off, *computed})
            found = infer_markers(worn[:standing], worn[standing:], readings, shipped.body, leave_out)
        require_person(found, LEAST_NAMED_LOG_ODDS)
        left_out |= {one.name: OFF_BODY for one in found.markers if one.name in strangers and not one.segment}
        markers = protocol_markers(
            [one for one in found.markers if one.name in strangers and one.segment],
            shipped.body,
            {name for name in strangers if readings[name].kind == "keypoint"},
            {one.landmark for one in known.values()},
        )
    joined = replace(
        shipped,
        markers=(*shipped.markers, *markers),
        ignored={**shipped.ignored, **left_out},
        joined=unknown,
    )
    return JoinedSet(joined)


def _kind(marker: ProtocolMarker) -> str:
    """Kind of a reading of a known marker's name."""
    return marker.kind if marker.kind in ("computed", "keypoint") else "marker"
