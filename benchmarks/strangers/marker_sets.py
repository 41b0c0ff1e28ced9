"""Marker sets of strangers: heel clusters, sets that know a part of the names, computed points, parts, masses.

Spreads and bounds were set on ``clusters_heel_only.trc`` and on the captures of :data:`COMBINED`, while markers of
further public captures were looked at. To captures of :data:`OTHERS` made points are added.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from benchmarks.any_capture.marked import CAPTURES, Known, beside, known, leaking, renamed
from benchmarks.checks import Check
from mbkf.conventions import Array
from mbkf.errors import MbkfError
from mbkf.io.capture import read_capture
from mbkf.io.records import Capture, MarkerTrajectories
from mbkf.io.subject import Subject
from mbkf.marker_sets.combined_points import combined_points
from mbkf.marker_sets.names import read_names
from mbkf.model.human import HumanModel
from mbkf.model.protocol import load_protocol
from mbkf.sensors.posture_sensor import PostureSensor
from mbkf.trial.protocol.choice import choose_marker_set
from mbkf.trial.protocol.joined import with_others
from mbkf.trial.scale import scale

ANKLE_DEG = 15.0
"""Greatest angle of an ankle in standing."""

HEEL_M, HEEL_BOUND_M = np.array([-0.06, -0.04]), 0.03
"""Place of a heel cluster behind and below the ankle, and the greatest distance from it."""

CLUSTER_M = np.array(
    [[-0.075, 0.0, -0.02], [-0.06, 0.03, -0.035], [-0.06, -0.03, -0.03], [-0.08, 0.01, -0.05]]
)
"""A made cluster at the right heel, in the foot's frame of the reference body."""

JITTER_M = 0.0003
"""Noise of made markers."""

WITHHELD = ("pelvis", "foot", "shank", "thigh", "torso")
"""Ends of the names of segments whose markers' names are withheld from a set."""

LEAST_RIGHT, LEAST_KNOWN = 0.95, 0.6
"""Least share of markers that join the right segment, and of names that the set still knows."""

SURE = 0.9
"""Probability from which a wrong marker counts as not reported."""

EXPECTED = {
    "cmu_basketball/cmu_dribble_shoot_basketball.c3d": dict.fromkeys(
        ("LFWT", "RFWT", "LBWT", "RBWT"), "pelvis"
    ),
    "flywheel_squat/S1_StandingRef.c3d": {
        "LILC": "pelvis",
        "RILC": "pelvis",
        "LMT5": "left_foot",
        "RMT5": "right_foot",
    },
    "jam_walk/static1.trc": {"R.MT0": "right_foot", "L.MT0": "left_foot", "R.Melb": "right_upper_arm"},
    "unipd_walk/Static1.c3d": {
        "RVMH": "right_foot",
        "LVMH": "left_foot",
        "LIMH": "left_foot",
        "RIIT": "right_foot",
    },
}
"""Segments of markers that the shipped set of a capture does not know."""

OTHERS = (
    "autolabel_unlabelled_fullbody/PronetoRun01_labelled.c3d",
    "biomechzoo_walk_turn/HC044A_Straight_HC044A15.c3d",
    "cgm24_lowerlimb_walk/CGM24_Walking01.c3d",
    "fukuchi_run/RBDS001runT35.c3d",
    "gaitalytics_walk/overground_fullbody_4plates.c3d",
    "opencap_s6_walk/s6_walking1.trc",
)
"""Captures to which midpoints and centroids are added under names without a meaning."""

COMBINED = {
    "bmc_walk_run/run.trc": {"REJC", "LEJC", "Mid_ASIS", "Mid_PSIS"},
    "rajagopal_walk_run/static_walk_1.trc": {
        *(f"{side}.{joint}Joint" for side in "LR" for joint in ("Knee", "Ankle")),
        *("MidASIS", "MidPSIS", "MidClavicle"),
    },
    "ric_run/20140515T133244_run.c3d": {"pelvis_4", "L_foot_4", "R_foot_4"},
    "grand_challenge_knee/static.trc": {"Sacral"},
    "landings/aStaticTrial.c3d": {"OPelvis", "SACR", "fun_LAJC", "fun_RAJC"},
}
"""All points that are midpoints or centroids of others, by capture."""

OUTPUTS = (
    "AXIS1",
    "AXIS_X",
    "ORIGIN",
    "RHJC",
    "LKJC2",
    "PelvisCOM",
    "LKneeMoment",
    "LAnkleForce",
    "LKneeAngles",
)
OBJECTS = ("ScapLocTip1", "Wheelchair_R_Handle", "L_Handle")

UPPER = (
    "LSHO",
    "LUPA",
    "LELB",
    "LFRM",
    "LWRA",
    "LWRB",
    "RSHO",
    "RUPA",
    "RELB",
    "RFRM",
    "RWRA",
    "RWRB",
    "C7",
    "CLAV",
)
FINGERS = tuple(
    f"R{finger}{joint}" for finger in ("THUMB", "INDEX", "MIDDLE", "RING") for joint in ("MCP", "PIP", "TIP")
)
JAW = (
    "JAW_L",
    "JAW_R",
    "CHIN",
    "MANDIBLE_L",
    "MANDIBLE_R",
    "NOSE",
    "GLABELLA",
    "TRAGUS_L",
    "TRAGUS_R",
    "LIP1",
    "LIP2",
    "LIP3",
)


@dataclass(frozen=True)
class Joining:
    """Outcome of markers whose names a set does not know: their number, those right, and those wrong with certainty."""

    markers: int
    right: int
    unreported: int


def marker_set_rows(data: Path) -> list[Check]:
    """Rows of heel clusters, joined markers, computed points, parts of a body, and stated masses."""
    return [
        *heel_rows(data),
        *joined_rows(data),
        *computed_rows(data),
        *part_rows(data),
        *mass_rows(data),
    ]


def heel_rows(data: Path) -> Iterator[Check]:
    """Standing ankles and places of clusters at the heels, without a marker on the forefoot."""
    alone = scale(read_capture(data / "strangers3/clusters_heel_only.trc"), mass_kg=70.0)
    folder = data / "ric_run"
    runner = scale(
        read_capture(folder / "20140515T133244_static.c3d"),
        [read_capture(folder / "20140515T133244_run.c3d")],
        mass_kg=70.0,
    )
    for name, subject in (("heel clusters", alone), ("heel clusters, ric_run", runner)):
        yield Check(
            f"{name}: largest standing ankle", np.abs(ankles_deg(subject)).max(), ANKLE_DEG, "<=", "°"
        )
        yield Check(f"{name}: distance from the heel", _off_heel_m(subject), HEEL_BOUND_M, "<=", "m")
    off = [angle for marked in CAPTURES if marked.static for angle in _made_heels(known(marked, data))]
    yield Check("heel clusters, made: largest change of a standing ankle", np.max(off), ANKLE_DEG, "<=", "°")


def ankles_deg(subject: Subject) -> Array:
    """(2,) flexion of the right and left ankle in standing, degrees."""
    model = HumanModel.of(subject)
    assert subject.standing_q is not None
    turned, _ = PostureSensor(model).deviation(subject.standing_q)
    return np.rad2deg([turned[model.joint(f"{side}_foot").v][1] for side in ("right", "left")])


def _off_heel_m(subject: Subject) -> float:
    """Distance of the mean of a foot's markers from the place of a heel cluster, in depth and height, m."""
    return max(
        float(np.linalg.norm(np.mean([m.position_m[[0, 2]] for m in own], axis=0) - HEEL_M))
        for side in "RL"
        if (own := [m for m in subject.markers if m.name.startswith(f"{side}_foot")])
    )


def _made_heels(one: Known) -> Array:
    """(2,) change of the standing ankles where made heel clusters stand for the markers of the feet, degrees."""
    assert one.static is not None
    subject = scale(one.static, mass_kg=70.0, protocol=one.protocol)
    model = HumanModel.of(subject)
    assert subject.standing_q is not None
    rotations, origins = model.placements(subject.standing_q)
    segments = one.segments
    kept = one.static.markers.select(
        tuple(name for name in one.static.markers.names if not segments[name].endswith(("foot", "toes")))
    )
    names, points = list(kept.names), [kept.positions_m]
    for side, sense in (("right", 1.0), ("left", -1.0)):
        joint = model.joint(f"{side}_foot").joint_id
        local = model.axis_scale(model.description.segment(f"{side}_foot")) * CLUSTER_M * [1.0, sense, 1.0]
        world = origins[joint] + local @ rotations[joint].T
        noise = np.random.default_rng(3).normal(0.0, JITTER_M, (kept.frames, *world.shape))
        points.append(world + noise)
        names += [f"{side[0].upper()}_foot_{k}" for k in range(1, 5)]
    markers = MarkerTrajectories(tuple(names), np.concatenate(points, axis=1), kept.rate_hz)
    found = scale(replace(one.static, markers=markers), mass_kg=70.0)
    return np.abs(ankles_deg(found) - ankles_deg(subject))


def joined_rows(data: Path) -> Iterator[Check]:
    """Markers that a shipped set does not know: those of public captures, and segments whose names are withheld."""
    total = right = 0
    for name, expected in EXPECTED.items():
        capture = read_capture(data / name)
        chosen = choose_marker_set(capture, ())
        segments = {marker.name: marker.segment for marker in chosen.protocol.markers}
        total += len(expected)
        right += sum(beside(segments.get(marker, ""), true) for marker, true in expected.items())
    yield Check("joined to a shipped set, public captures: right", right / total, 1.0, ">=")
    found = [
        joining
        for k, marked in enumerate(CAPTURES)
        for joining in withheld(known(marked, data), (WITHHELD[k % 5], WITHHELD[(k + 2) % 5]))
    ]
    markers = sum(one.markers for one in found)
    yield Check("joined to a shipped set, segments withheld: cases", len(found), 25, ">=")
    yield Check(
        "joined to a shipped set, segments withheld: right",
        sum(one.right for one in found) / markers,
        LEAST_RIGHT,
        ">=",
    )
    unreported = sum(one.unreported for one in found) / markers
    yield Check("joined to a shipped set, segments withheld: wrong and not reported", unreported, 0.01, "<=")


def withheld(one: Known, ends: Sequence[str] = WITHHELD) -> Iterator[Joining]:
    """Outcomes with the names of one segment after the other withheld, where the set knows enough of the rest.

    Args:
        one: The capture.
        ends: Ends of the names of the segments.
    """
    truth = one.segments
    for end in ends:
        own = [name for name, segment in truth.items() if segment.endswith(end)]
        if not own or len(own) > (1.0 - LEAST_KNOWN) * len(truth):
            continue
        names = {name: f"M{k:02d}" if name in own else name for k, name in enumerate(truth)}
        static = None if one.static is None else renamed(one.static, names)
        leaks = (*one.withheld, *leaking(tuple(truth)))
        try:
            joined = with_others(one.protocol, static, [renamed(one.trial, names)], leaks)
        except MbkfError:
            joined = None
        markers = {} if joined is None else {marker.name: marker for marker in joined.markers}
        pairs = [(markers.get(names[name]), truth[name]) for name in own]
        good = [marker is not None and beside(marker.segment, true) for marker, true in pairs]
        sure = [marker is not None and marker.probability >= SURE for marker, _ in pairs]
        yield Joining(len(own), sum(good), sum(s and not g for g, s in zip(good, sure, strict=True)))


def computed_rows(data: Path) -> Iterator[Check]:
    """Midpoints and centroids by geometry, and outputs of software and objects by name."""
    missed = accused = 0
    for name, points in COMBINED.items():
        found = set(combined_points([read_capture(data / name).markers]))
        missed, accused = missed + len(points - found), accused + len(found - points)
    yield Check("computed points of public captures: not found", missed, 0, "<=")
    yield Check("computed points of public captures: skin taken for one", accused, 0, "<=")
    missed = accused = 0
    for name in OTHERS:
        markers, made = with_combinations(read_capture(data / name).markers)
        found = set(combined_points([markers]))
        missed, accused = missed + len(made - found), accused + len(found - made)
    yield Check("computed points, made among markers of other captures: not found", missed, 0, "<=")
    yield Check("computed points, made among markers of other captures: skin taken for one", accused, 0, "<=")
    worn = load_protocol("plug_in_gait")
    skin = tuple(marker.name for marker in worn.markers if marker.kind != "computed")
    kinds = {name: one.kind for name, one in read_names((*skin, *OUTPUTS, *OBJECTS)).items()}
    right = sum(kinds[name] == "computed" for name in OUTPUTS) + sum(
        kinds[name] == "object" for name in OBJECTS
    )
    yield Check("outputs and objects by name", right, len(OUTPUTS) + len(OBJECTS), ">=")


def with_combinations(markers: MarkerTrajectories, count: int = 6) -> tuple[MarkerTrajectories, set[str]]:
    """The markers with midpoints and centroids of neighbours under names without a meaning, and those names."""
    rng = np.random.default_rng(9)
    shown = np.flatnonzero(markers.present.mean(axis=0) > 0.9)
    points = markers.positions_m[:, shown]
    made = []
    for k in range(count):
        first = int(rng.integers(len(shown)))
        away = np.nanmean(np.linalg.norm(points - points[:, first, None], axis=2), axis=0)
        near = np.argsort(away)[: 2 + k % 3]
        made.append(points[:, near].mean(axis=1))
    names = tuple(f"V{k}" for k in range(count))
    positions = np.concatenate([markers.positions_m, np.stack(made, axis=1)], axis=1)
    return replace(markers, names=(*markers.names, *names), positions_m=positions), set(names)


def part_rows(data: Path) -> Iterator[Check]:
    """Messages on captures of an upper body, of a hand and of a jaw: parts seen and missing, no word on the unit."""
    capture = read_capture(data / "cmu_basketball/cmu_dribble_shoot_basketball.c3d")
    shown = scale(None, [replace(capture, markers=capture.markers.select(UPPER))], mass_kg=70.0)
    sentences = [str(shown.report), *(_refusal(names) for names in (FINGERS, JAW))]
    words = (("trunk", "pelvis", "legs"), ("hand", "trunk", "pelvis"), ("head", "trunk", "pelvis"))
    right = [
        all(word in sentence for word in some) and "--unit" not in sentence
        for sentence, some in zip(sentences, words, strict=True)
    ]
    yield Check("parts of a body named: upper body, hand, jaw", sum(right), len(right), ">=")


def _refusal(names: Sequence[str]) -> str:
    """The message on points of a small part of a body with these names."""
    rng = np.random.default_rng(1)
    points = rng.uniform([-0.08, -0.08, 1.0], [0.08, 0.08, 1.12], (len(names), 3))
    positions = points + rng.normal(0.0, JITTER_M, (50, len(names), 3))
    try:
        scale(Capture("part.trc", MarkerTrajectories(tuple(names), positions, 100.0)), mass_kg=70.0)
    except MbkfError as error:
        return str(error)
    return ""


def mass_rows(data: Path) -> Iterator[Check]:
    """Masses that contradict the one that the file states by more than a tenth, and that agree with it."""
    static = read_capture(data / "functional_walk/FunctionalStatic.c3d")
    child = read_capture(data / "biomechzoo_walk_turn/HC044A_Static_HC044A01.c3d")
    reported = [
        "states a body mass" in str(scale(one, mass_kg=kg).report)
        for one, kg in ((static, 75.0), (static, 50.0), (child, 60.0), (static, 62.0), (child, 40.0))
    ]
    right = sum(
        found == wanted for found, wanted in zip(reported, (True, True, True, False, False), strict=True)
    )
    yield Check("masses against the file's own: right", right, len(reported), ">=")
