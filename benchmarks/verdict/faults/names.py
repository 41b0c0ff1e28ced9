"""Faults of names: exchanged within a limb, across sides, in the standing trial, and limbs in a wrong pose."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from benchmarks.limbs.faults import POSES
from benchmarks.verdict.recorded import Recorded, Thrown
from mbkf.io.records import Capture
from mbkf.io.subject import Subject
from mbkf.model.human import HumanModel
from mbkf.sensors.limb_starts import opposite_markers
from mbkf.sensors.marker_sensor import MarkerSensor

LEG_SEGMENTS = ("thigh", "shank", "foot", "toes")
FROM_FRAME = (0.2, 0.7)
"""Shares of the trial between which a fault of a part of it begins."""

Pairs = Sequence[tuple[str, str]]


def of_leg(subject: Subject, side: str, names: Sequence[str] = ()) -> list[str]:
    """Names of the markers of a leg.

    Args:
        subject: The person.
        side: "right" or "left".
        names: Only these; empty for all.
    """
    own = {f"{side}_{one}" for one in LEG_SEGMENTS}
    return [one.name for one in subject.markers if one.segment in own and (not names or one.name in names)]


def any_leg(recorded: Recorded, rng: np.random.Generator) -> list[str]:
    """Names of the markers of one leg, either of them, that the capture holds."""
    side = ("right", "left")[int(rng.integers(2))]
    return of_leg(recorded.subject, side, recorded.capture.markers.names)


def across(recorded: Recorded) -> list[tuple[str, str]]:
    """Pairs of markers of the right and the left leg that mirror each other."""
    markers = recorded.subject.markers
    sensor = MarkerSensor(
        HumanModel.of(recorded.subject),
        [one.segment for one in markers],
        np.array([one.position_m for one in markers]),
    )
    names = [one.name for one in markers]
    right = set(of_leg(recorded.subject, "right"))
    pairs = [(names[a], names[b]) for a, b in opposite_markers(sensor).items() if names[a] in right]
    held = set(recorded.capture.markers.names)
    return [(a, b) for a, b in pairs if a in held and b in held]


def renamed(capture: Capture, pairs: Pairs, first: int = 0) -> Capture:
    """A capture with exchanged names.

    Args:
        capture: The capture.
        pairs: Names that are exchanged.
        first: From this frame on.
    """
    names, positions = capture.markers.names, capture.markers.positions_m.copy()
    for a, b in pairs:
        if a in names and b in names:
            at, to = names.index(a), names.index(b)
            positions[first:, [at, to]] = positions[first:, [to, at]]
    return replace(capture, markers=replace(capture.markers, positions_m=positions))


def _chosen(names: Sequence[str], rng: np.random.Generator) -> tuple[str, str]:
    a, b = rng.choice(len(names), 2, replace=False)
    return names[int(a)], names[int(b)]


def within_limb(recorded: Recorded, rng: np.random.Generator) -> tuple[Recorded, str]:
    """Two markers of a leg have each other's names."""
    pair = _chosen(any_leg(recorded, rng), rng)
    return replace(recorded, capture=renamed(recorded.capture, [pair])), f"{pair[0]} and {pair[1]}"


def across_sides(recorded: Recorded, rng: np.random.Generator) -> tuple[Recorded, str]:
    """Markers of both legs that mirror each other have each other's names: one pair or two."""
    pairs = across(recorded)
    chosen = [pairs[int(k)] for k in rng.choice(len(pairs), int(rng.integers(1, 3)), replace=False)]
    label = ", ".join(f"{a} and {b}" for a, b in chosen)
    return replace(recorded, capture=renamed(recorded.capture, chosen)), label


def whole_legs(recorded: Recorded, rng: np.random.Generator) -> tuple[Recorded, str]:  # noqa: ARG001
    """All markers of a leg have the other leg's names."""
    return replace(recorded, capture=renamed(recorded.capture, across(recorded))), "all of both legs"


def from_a_frame_on(recorded: Recorded, rng: np.random.Generator) -> tuple[Recorded, str]:
    """Two markers of a leg have each other's names from a frame on."""
    pair, first = _chosen(any_leg(recorded, rng), rng), _begins(recorded, rng)
    label = f"{pair[0]} and {pair[1]} from frame {first} on"
    return replace(recorded, capture=renamed(recorded.capture, [pair], first)), label


def in_static(recorded: Recorded, rng: np.random.Generator) -> tuple[Recorded, str]:
    """Two markers of a leg, or a pair that mirrors each other, have each other's names in the standing trial."""
    assert recorded.static is not None
    mirrored = across(recorded)
    pair = (
        mirrored[int(rng.integers(len(mirrored)))]
        if rng.random() < 0.5
        else _chosen(any_leg(recorded, rng), rng)
    )
    static = renamed(recorded.static, [pair])
    return replace(recorded, static=static, scale_again=True), f"{pair[0]} and {pair[1]}"


def limb_thrown(recorded: Recorded, rng: np.random.Generator) -> tuple[Recorded, str]:
    """The filter is thrown into a wrong pose of a leg: turned over, its next segment turned over, or mirrored."""
    kind, side = POSES[int(rng.integers(len(POSES)))], ("right", "left")[int(rng.integers(2))]
    thrown = Thrown(kind, f"{side}_thigh", _begins(recorded, rng))
    return replace(recorded, thrown=thrown), f"{thrown.limb} {kind} at frame {thrown.frame}"


def _begins(recorded: Recorded, rng: np.random.Generator) -> int:
    return round(float(rng.uniform(*FROM_FRAME)) * recorded.capture.markers.frames)
