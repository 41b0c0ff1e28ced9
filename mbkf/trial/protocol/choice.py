"""The marker set of a person's captures: the shipped protocol that knows them, else an inferred one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from mbkf.errors import UnknownName
from mbkf.io.records import Capture
from mbkf.model.description import BodyDescription
from mbkf.model.protocol import Protocol, detect_protocol
from mbkf.trial.preparation.coverage import use_by_protocol
from mbkf.trial.protocol.inferred import InferredSet, infer_marker_set


@dataclass(frozen=True)
class ChosenSet:
    """A marker set and its captures.

    Attributes:
        protocol: The marker set.
        captures: The captures; with an inferred set, with corrected axes.
        inferred: The inferred set, None for a shipped protocol.
    """

    protocol: Protocol
    captures: tuple[Capture, ...]
    inferred: InferredSet | None = None


def choose_marker_set(
    static: Capture | None, trials: Sequence[Capture], body: BodyDescription | None = None
) -> ChosenSet:
    """The marker set of a person's captures.

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
        return ChosenSet(shipped, captures)
    return inferred_choice(static, trials, body)


def inferred_choice(
    static: Capture | None, trials: Sequence[Capture], body: BodyDescription | None = None
) -> ChosenSet:
    """The same, always inferred.

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
