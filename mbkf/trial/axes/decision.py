"""Decision on a capture's axes, from the body and the plates in it: kept, corrected or refused."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import InvalidInput
from mbkf.io.axes import (
    METRES_PER_UNIT,
    WORLD_AXES,
    axes_matrix,
    axes_text,
    nearest_axis,
    rotation_to_world,
)
from mbkf.io.records import AxesSource, Capture
from mbkf.io.turning import recentred, turned
from mbkf.numerics.printed import percent
from mbkf.trial.axes.evidence import FLAT_SINE, BodyAttitude, MarkerPlaces, body_attitude
from mbkf.trial.axes.plates import contradiction, pushed_away

UPRIGHT_COSINE = np.cos(np.deg2rad(30.0))
"""A body stands upright along an axis within this angle of its height."""

ALWAYS, EVER = 0.95, 0.05
"""Shares of frames: upright all the time, and at times. A person who stands along an axis in all frames of a capture,
with straight legs and feet across it, is not lying; one who does so at times may rise from the floor."""

STRAIGHT = 0.6
"""Height over that of the reference body of the same size, above which a body is not folded."""

STANDING = 0.5
"""Share of the frames upright along an axis with a foot across it from which a person stands along it: 1 in a walk,
0.93 in a run; 0.2 to 0.35 in two persons who lie with their toes on the floor."""

HANDED, SAME_SIGN = 0.3, 0.9
"""Mean triple product of forward, left and up, and the share of frames of its sign, from which the body is taken to be
right-handed or mirrored. Twenty-five measured captures have means of 0.63 (legs alone) to 1 and shares of 0.98 to 1."""

EXPLAINED, SCATTER = 0.7, 0.45
"""Share of the markers' spread that a body has to explain (measured captures: 0.78 to 0.98), and the scatter of lengths
within segments that it may have (0.05 to 0.32; names in a wrong order 0.64 and more): else the names are others'."""

POSSIBLE_M, PLAUSIBLE_M = (0.65, 2.6), (1.0, 2.2)
"""Heights of a person outside which a unit is refused, and between which another is proposed."""

LOWEST_PERCENT = 1.0
"""Percentile of heights that counts as the lowest: single samples may be ghosts."""

FLOOR_M = (-0.05, 0.15)
"""Heights over the origin of the lowest markers of a person who stands on a floor there: those of soles to ankles. With
lower ones along an axis the person would be under the floor."""

RISES_M = 0.3
"""Range of the height of a body's lowest marker beyond which the body does not lie."""

SMALL = ("head", "neck", "hand", "foot", "toes")
"""Segments too small for their markers to show a person's size: names of fingers or of a jaw mean no exact place."""

_AXES = {name: np.array(rows[2], dtype=np.float64) for name, rows in WORLD_AXES.items()}
"""World directions by the names of axes."""


class Verdict(StrEnum):
    """Verdict on a capture's axes."""

    RIGHT = "right"
    """Up and handedness are those of the body."""
    PUT_RIGHT = "put right"
    """Up or handedness were wrong; the right ones are clear."""
    KEPT = "kept"
    """The axes may be wrong; they are kept, for the reason that the note gives."""
    UNCLEAR = "unclear"
    """The person lies and never stands, and the file does not state the axis that points up."""
    REFUSED = "refused"
    """Body and plates, or body and file, contradict each other."""
    UNKNOWN = "unknown"
    """Too few markers with a known place on the body."""
    GIVEN = "given"
    """The caller named the axes."""


@dataclass(frozen=True)
class AxesFinding:
    """Verdict on a capture's axes and correction.

    Attributes:
        verdict: The verdict.
        turn: (3, 3) signed permutation that corrects the capture; the identity unless axes are put right.
        note: One line for the user, or "".
    """

    verdict: Verdict
    turn: Array
    note: str = ""


def right_axes(
    captures: Sequence[Capture],
    places: Sequence[MarkerPlaces],
    *,
    with_plates: bool = True,
    standing: int = 0,
) -> list[Capture]:
    """Captures of one person with their axes checked and, if wrong, corrected.

    A capture without evidence takes the axes of the others that were read alike: a laboratory's static and moving
    trials have the same. Evidence of its own is not overruled.

    Args:
        captures: The captures.
        places: Places of each one's markers on the body.
        with_plates: True to refuse upright captures whose plates push in another direction than up.
        standing: Number of captures, from the first on, in which the person is known to stand.

    Returns:
        The captures, in their order; the same objects where nothing was changed or remarked.

    Raises:
        InvalidInput: Body, plates and file contradict each other, or the body's height is impossible.
    """
    found = [
        find_axes(one, place, with_plates=with_plates, standing=k < standing)
        for k, (one, place) in enumerate(zip(captures, places, strict=True))
    ]
    known: dict[tuple[str, AxesSource], list[AxesFinding]] = {}
    for one, finding in zip(captures, found, strict=True):
        if finding.verdict in (Verdict.RIGHT, Verdict.PUT_RIGHT):
            known.setdefault((one.axes, one.axes_source), []).append(finding)
    result = []
    for one, own in zip(captures, found, strict=True):
        others = known.get((one.axes, one.axes_source), [])
        agreed = bool(others) and all(np.array_equal(other.turn, others[0].turn) for other in others)
        result.append(applied(one, others[0] if agreed and may_follow(own, others[0].turn) else own))
    return result


def may_follow(finding: AxesFinding, turn: Array) -> bool:
    """True if a capture with this finding may be turned as another one of the same person was, by ``turn`` (3, 3)."""
    if finding.verdict is Verdict.KEPT:  # its up is known, its handedness is not
        return bool(turn[2, 2] == 1.0)
    return finding.verdict in (Verdict.UNKNOWN, Verdict.UNCLEAR)


def applied(capture: Capture, finding: AxesFinding) -> Capture:
    """The capture turned and with the note of a finding.

    Raises:
        InvalidInput: Its axes or its unit are wrong, and the right ones are not clear.
    """
    if finding.verdict in (Verdict.REFUSED, Verdict.UNCLEAR):
        raise InvalidInput(f"{capture.path or 'capture'}: {finding.note}")
    if finding.verdict is Verdict.PUT_RIGHT:
        capture = put_right(capture, finding.turn)
    return replace(capture, notes=(*capture.notes, finding.note)) if finding.note else capture


def put_right(capture: Capture, turn: Array) -> Capture:
    """A capture turned into the axes of the body in it by a signed permutation (3, 3)."""
    found = turned(capture, turn, AxesSource.BODY)
    return replace(found, plates=tuple(recentred(plate) for plate in found.plates))


def find_axes(
    capture: Capture, places: MarkerPlaces, *, with_plates: bool = True, standing: bool = False
) -> AxesFinding:
    """Verdict on a capture's axes by the person in it.

    Args:
        capture: A capture whose markers have names.
        places: Places of its markers on the body.
        with_plates: As in :func:`right_axes`.
        standing: True where the person is known to stand.
    """
    same = np.eye(3)
    if capture.axes_source is AxesSource.GIVEN:
        return AxesFinding(Verdict.GIVEN, same)
    body = body_attitude(capture.markers, places)
    if body is None or np.median(body.explained) < EXPLAINED or body.scatter > SCATTER:
        return AxesFinding(Verdict.UNKNOWN, same)
    if impossible := _impossible_size(capture, body, places):
        return AxesFinding(Verdict.REFUSED, same, impossible)
    old, up, mirrored = axes_matrix(capture.axes), _up(capture, body, standing), _mirrored(body)
    if up.unclear:
        return AxesFinding(Verdict.UNCLEAR, same, up.remark)
    remarks = [up.remark] if up.remark else []
    if mirrored is None:
        remarks.append("the markers do not show whether they are mirrored")
    new = old if up.axis == "z" else rotation_to_world(_stored(up.axis, old))
    if mirrored:
        new = new * np.array([[1.0], [-1.0], [1.0]])
    turn = new @ old.T
    evidence = _evidence(body, up.axis, bool(mirrored), old)
    if np.array_equal(turn, same):
        against = pushed_away(capture.plates) if with_plates and _stands_along(body, "z") else ""
        if against:
            hint = "check the axes of both (--up, --axes)"
            return AxesFinding(Verdict.REFUSED, same, f"the body stands upright, but {against}; {hint}")
        return AxesFinding(Verdict.KEPT if remarks else Verdict.RIGHT, same, "; ".join(remarks))
    if against := contradiction(capture, turn, places):
        hint = f"name the axes that point forward, left and up (--axes={capture.axes} keeps them)"
        return AxesFinding(Verdict.REFUSED, same, f"{evidence}, but {against}; {hint}")
    correction = _correction(capture, axes_text(new), evidence, up.axis)
    return AxesFinding(Verdict.PUT_RIGHT, turn, "; ".join([correction, *remarks]))


@dataclass(frozen=True)
class _Up:
    """World axis that points up in truth, a remark for the user, and True if the axis is not clear."""

    axis: str
    remark: str = ""
    unclear: bool = False


def _up(capture: Capture, body: BodyAttitude, standing_trial: bool) -> _Up:
    """The axis that points up: the body's own, or, for a person who lies at times, the one along which it stands.

    Markers at the heels alone do not show that a foot lies across an axis; a standing trial does.
    """
    main = nearest_axis(body.up.mean(axis=0))
    standing = [a for a in _AXES if _along(body, a) >= EVER and _on_feet(body, a) >= STANDING]
    axis = main
    if main == "z" and standing and "z" not in standing:
        axis = standing[0]
    if axis == "z":
        return _Up("z")
    stored = _stored(axis, axes_matrix(capture.axes))
    share = f"in {percent(_along(body, axis))} of frames the body extends along {stored} of the file"
    if capture.axes_source is AxesSource.UP_GIVEN:
        return _Up("z", f"{share}; up is {capture.up_axis}, as given")
    if axis == main and _stands_along(body, axis):
        return _Up(axis)
    stated = capture.axes_source in (AxesSource.PLATES, AxesSource.MADE)
    if not stated and np.isnan(body.feet).all() and _on_floor(capture, axis):
        return _Up(axis)
    if stated or capture.axes_source is AxesSource.SCREEN:
        return _Up("z", f"{share}; up is {capture.up_axis}, as the file says")
    if standing_trial and axis == main and np.isnan(body.feet).all() and _extends_along(body, axis):
        return _Up(axis)
    if standing == ["z"]:
        return _Up(
            "z",
            f"{share}, but stands on its feet along {capture.up_axis} only; {capture.up_axis} is taken as up",
        )
    hint = f"name the axis that points up with --up (--up={capture.up_axis} if the person lies)"
    return _Up("z", f"{share} and does not stand along {capture.up_axis}, taken as up; {hint}", unclear=True)


def _on_floor(capture: Capture, axis: str) -> bool:
    """True where the lowest markers lie over the origin as feet do along an axis, and not as one lies along z."""
    markers = capture.markers
    along, up = np.moveaxis(markers.positions_m @ np.stack([_AXES[axis], _AXES["z"]], axis=1), 2, 0)
    stands = FLOOR_M[0] <= np.nanpercentile(along, LOWEST_PERCENT) <= FLOOR_M[1]
    lowest = np.nanmin(up[markers.present.any(axis=1)], axis=1)
    rises = np.subtract(*np.percentile(lowest, (100.0 - LOWEST_PERCENT, LOWEST_PERCENT)))
    return bool(stands and (np.nanpercentile(up, LOWEST_PERCENT) < FLOOR_M[0] or rises > RISES_M))


def _stored(axis: str, matrix: Array) -> str:
    """Name in the file of a world axis."""
    return nearest_axis(_AXES[axis] @ matrix)


def _along(body: BodyAttitude, axis: str) -> float:
    """Share of the frames in which the body extends upwards along a world axis."""
    return float((body.up @ _AXES[axis] > UPRIGHT_COSINE).mean())


def _stands_along(body: BodyAttitude, axis: str) -> bool:
    """True if the body stands on its feet along a world axis all the time, with straight legs."""
    return _extends_along(body, axis) and _on_feet(body, axis) >= STANDING


def _extends_along(body: BodyAttitude, axis: str) -> bool:
    """True if the body extends along a world axis all the time, with straight legs."""
    straight = bool(np.median(body.stretch) >= STRAIGHT * body.size)
    return straight and _along(body, axis) >= ALWAYS


def _on_feet(body: BodyAttitude, axis: str) -> float:
    """Share of the frames upright along a world axis in which a foot lies across it; 0 without a seen foot."""
    along = body.up @ _AXES[axis] > UPRIGHT_COSINE
    rise = np.abs(body.feet[along] @ _AXES[axis])
    seen = ~np.isnan(rise).all(axis=1)
    return float((np.nanmin(rise[seen], axis=1) < FLAT_SINE).mean()) if seen.any() else 0.0


def _mirrored(body: BodyAttitude) -> bool | None:
    """True if right and left are exchanged; None without evidence."""
    seen = body.handedness[~np.isnan(body.handedness)]
    if not len(seen) or abs(seen.mean()) < HANDED:
        return None
    mirrored = bool(seen.mean() < 0.0)
    return mirrored if ((seen < 0.0) == mirrored).mean() >= SAME_SIGN else None


def _impossible_size(capture: Capture, body: BodyAttitude, places: MarkerPlaces) -> str:
    """Message on a body too small or too large for a person, whose unit is wrong; "" otherwise."""
    height, used = body.size * places.height_m, capture.length_unit
    unknown = np.isnan(height) or all(segment.endswith(SMALL) for segment in places.segments)
    if unknown or POSSIBLE_M[0] <= height <= POSSIBLE_M[1]:
        return ""
    hint = "give the right unit with --unit"
    for unit, metres in METRES_PER_UNIT.items():
        other = height * metres / METRES_PER_UNIT[used]
        if PLAUSIBLE_M[0] <= other <= PLAUSIBLE_M[1]:
            hint = f"in {unit} it is {other:.2f} m: give --unit {unit}"
            break
    low, high = POSSIBLE_M
    return f"read in {used}, the body is {height:.4g} m tall, outside {low:g} to {high:g} m; {hint}"


def _evidence(body: BodyAttitude, axis: str, mirrored: bool, old: Array) -> str:
    """Reason for corrected axes, in words."""
    words = []
    if axis != "z":
        words.append(f"the body stands along {_stored(axis, old)} in {percent(_along(body, axis))} of frames")
    if mirrored:
        words.append("right markers lay left of the left ones")
    return " and ".join(words)


def _correction(capture: Capture, new: str, evidence: str, axis: str) -> str:
    """Correction of axes, in one line."""
    kept = f"--axes={capture.axes} keeps them"
    if axis == "z":
        what = "markers and plates" if capture.plates else "markers"
        flipped = new.split(",")[1].removeprefix("-")
        return f"{what} mirrored: {flipped} flipped ({evidence}); {kept}"
    return f"axes put right: {new} point forward, left and up, not {capture.axes} ({evidence}); {kept}"
