"""The marker set of a person's captures: the shipped protocol that knows most of them, else an inferred one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from mbkf.errors import MbkfError, UnknownName
from mbkf.io.records import Capture
from mbkf.model.description import BodyDescription
from mbkf.model.protocol import Protocol, detect_protocol
from mbkf.trial.preparation.coverage import use_by_protocol
from mbkf.trial.protocol.inferred import InferredSet, infer_marker_set
from mbkf.trial.protocol.joined import JoinedSet, with_others


@dataclass(frozen=True)
class ChosenSet:
    """A marker set and its captures.

    Attributes:
        protocol: The marker set.
        captures: The captures; with an inferred set, with corrected axes.
        inferred: The inferred set, or the shipped protocol joined by markers that it does not know; None for a shipped
            protocol alone.
    """

    protocol: Protocol
    captures: tuple[Capture, ...]
    inferred: InferredSet | JoinedSet | None = None

    @property
    def shipped(self) -> bool:
        """True for a shipped protocol, joined by further markers or not."""
        return not isinstance(self.inferred, InferredSet)

    @property
    def exchanged(self) -> tuple[tuple[str, str, int], ...]:
        """Names exchanged against the standing trial, and numbers of frames; corrected in the captures."""
        return self.inferred.exchanged if isinstance(self.inferred, InferredSet) else ()


def choose_marker_set(
    static: Capture | None, trials: Sequence[Capture], body: BodyDescription | None = None
) -> ChosenSet:
    """The marker set of a person's captures.

    Markers that a shipped protocol does not know join it by inference.

    Args:
        static: A standing trial, if there is one.
        trials: Trials of any movement.
        body: The reference body; by default the one that the protocol was written for.

    Raises:
        InvalidInput: The axes of a capture contradict the body.
        NotObservable: No shipped protocol knows enough of the markers, and no body is found among them.
    """
    captures = (*([] if static is None else [static]), *trials)
    shipped = shipped_protocol(captures, body)
    if shipped is not None:
        return _joined(ChosenSet(shipped, captures), static, trials)
    return inferred_choice(static, trials, body)


def _joined(chosen: ChosenSet, static: Capture | None, trials: Sequence[Capture]) -> ChosenSet:
    """A shipped set with the markers that it does not know, without them where no body is found."""
    try:
        joined = with_others(chosen.protocol, static, trials)
    except MbkfError:
        return chosen
    return chosen if joined is None else replace(chosen, protocol=joined.protocol, inferred=joined)


def inferred_choice(
    static: Capture | None, trials: Sequence[Capture], body: BodyDescription | None = None
) -> ChosenSet:
    """The marker set of a person's captures, always inferred.

    Args:
        static: A standing trial, if there is one.
        trials: Trials of any movement.
        body: The reference body.

    Raises:
        InvalidInput: The axes of a capture contradict the body.
        NotObservable: Too few markers, or no body is found among them.
    """
    inferred = infer_marker_set(static, trials, body)
    return ChosenSet(inferred.protocol, inferred.captures, inferred)


def shipped_protocol(captures: Sequence[Capture], body: BodyDescription | None = None) -> Protocol | None:
    """The shipped protocol that knows enough of the markers of a person's captures, static one first, or None."""
    try:
        protocol = detect_protocol(captures[0].markers.names, body)
    except UnknownName:
        return None
    use = use_by_protocol([one.markers for one in captures], protocol)
    return protocol if use.accepted else None
