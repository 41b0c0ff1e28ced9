"""Captures whose marker set is known, told apart from what is inferred of them: names hidden, the set withheld."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from mbkf.io.capture import read_capture
from mbkf.io.records import Capture
from mbkf.model.protocol import Protocol, detect_protocol, load_protocol, protocol_names
from mbkf.trial.axes.captures import checked_for_protocol

LEAKS = 0.5
"""A shipped set that knows more than this share of a capture's names does not count while that capture is judged."""

NEIGHBOURS = (
    {"thigh", "shank"},
    {"shank", "foot"},
    {"foot", "toes"},
    {"upper_arm", "forearm"},
    {"forearm", "hand"},
)
"""Segments of one side that share a joint: a marker on its line may move with either."""


@dataclass(frozen=True)
class Marked:
    """A capture with a shipped protocol.

    Attributes:
        name: For the rows.
        folder: Its folder, below the data folder.
        trial: The moving trial.
        static: The standing trial, where there is one.
        walks: Whether the angles of its legs are compared: it walks or runs, or bends a knee.
        quick: Whether it is judged in a quick run.
    """

    name: str
    folder: str
    trial: str
    static: str | None = None
    walks: bool = True
    quick: bool = False


CAPTURES = (
    Marked("gait2354", "gait2354_walk", "subject01_walk1.trc", "subject01_static.trc", quick=True),
    Marked("rajagopal walk", "rajagopal_walk_run", "motion_capture_walk.trc", "static_walk_1.trc"),
    Marked("rajagopal run", "rajagopal_walk_run", "motion_capture_run.trc", "static_run.trc"),
    Marked("HC032A", "biomechzoo_walk_turn", "HC032A_Straight_HC032A03.c3d", "HC032A_Static_HC032A01.c3d"),
    Marked("HC044A", "biomechzoo_walk_turn", "HC044A_Straight_HC044A15.c3d", "HC044A_Static_HC044A01.c3d"),
    Marked("gaitalytics", "gaitalytics_walk", "overground_fullbody_4plates.c3d"),
    Marked("opensim gappy", "opensim_gappy_walk", "walking2.c3d"),
    Marked("autolabel run", "autolabel_unlabelled_fullbody", "PronetoRun01_labelled.c3d", walks=False),
    Marked("autolabel kneel", "autolabel_unlabelled_fullbody", "KneeltoProne01_labelled.c3d", walks=False),
    Marked("rehazenter", "rehazenter_walk", "2014001_C1_01.c3d", "2014001_ST_static.c3d"),
    Marked("bmc run", "bmc_walk_run", "run.trc", "run_static.trc"),
    Marked("bmc lower walk", "bmc_walk_run", "lower_walk1.trc", quick=True),
    Marked("biobuddy", "biobuddy_functional", "functional_right_knee.c3d", "static.c3d"),
    Marked("cgm24", "cgm24_lowerlimb_walk", "CGM24_Walking01.c3d"),
    Marked("stoop lift", "stoop_lift_box", "stoop1_t169_f620f800.c3d", "neu_t169_f250f350.c3d", walks=False),
)


@dataclass(frozen=True)
class Known:
    """A capture and the truth about its markers.

    Attributes:
        name: Of the capture.
        static: The standing trial, upright, with the markers that the protocol places on a segment and no others.
        trial: The same of the moving trial.
        protocol: The protocol that knows them.
        withheld: Shipped protocols that do not count while it is judged.
    """

    name: str
    static: Capture | None
    trial: Capture
    protocol: Protocol
    withheld: tuple[str, ...]

    @property
    def captures(self) -> tuple[Capture, ...]:
        """Both trials, the standing one first where there is one."""
        return (self.trial,) if self.static is None else (self.static, self.trial)

    @property
    def segments(self) -> dict[str, str]:
        """The segment of every marker, by its name."""
        names = [name for one in self.captures for name in one.markers.names]
        return {name: marker.segment for name, marker in self.protocol.match(names).items()}


def known(marked: Marked, data: Path) -> Known:
    """Reads a capture and keeps the markers whose segment is known.

    Args:
        marked: Which.
        data: Folder of the reference captures.
    """
    folder = data / marked.folder
    read = [read_capture(folder / file) for file in (marked.static, marked.trial) if file is not None]
    protocol = detect_protocol(read[0].markers.names)
    worn = [_worn(one, protocol) for one in checked_for_protocol(read, protocol)]
    static = None if marked.static is None else worn[0]
    names = tuple(dict.fromkeys(name for one in worn for name in one.markers.names))
    return Known(marked.name, static, worn[-1], protocol, leaking(names))


def leaking(names: tuple[str, ...]) -> tuple[str, ...]:
    """Shipped protocols that know too many of these names to be used in a trial on them."""
    return tuple(one for one in protocol_names() if len(load_protocol(one).match(names)) > LEAKS * len(names))


def _worn(capture: Capture, protocol: Protocol) -> Capture:
    """The capture with the markers on the body alone that are seen, without computed points."""
    places = protocol.match(capture.markers.names)
    seen = np.asarray(capture.markers.present.any(axis=0))
    names = tuple(
        name
        for name, there in zip(capture.markers.names, seen, strict=True)
        if there and name in places and places[name].kind != "computed"
    )
    return replace(capture, markers=capture.markers.select(names))


def hidden_names(one: Known) -> dict[str, str]:
    """A name that tells nothing, by every marker's own."""
    names = dict.fromkeys(name for capture in one.captures for name in capture.markers.names)
    return {name: f"M{k:02d}" for k, name in enumerate(names, start=1)}


def renamed(capture: Capture, names: Mapping[str, str]) -> Capture:
    """The capture with other names.

    Args:
        capture: The capture.
        names: The new name by the old one.
    """
    markers = capture.markers
    return replace(capture, markers=replace(markers, names=tuple(names[name] for name in markers.names)))


def beside(one: str, other: str) -> bool:
    """Whether two segments are the same, or share the line of a joint."""
    if one == other:
        return True
    side, _, part = one.partition("_")
    other_side, _, other_part = other.partition("_")
    return side == other_side and {part, other_part} in NEIGHBOURS
