"""Squats in which one marker slides: how much knee angle, knee torque and residual of each filter follow it.

The thesis (4.2) finds its dynamic model very sensitive to the displacement of a single marker in squats, its marker 15,
and the kinematic filter less so. Its text does not say where that marker sits, so every marker of the right leg and the
pelvis slides in turn, in every direction of its segment, as deep as the squat is. A filter's sensitivity is what it
changes against its own estimate of the same trial without the slide; marker positions stay those of that trial.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from benchmarks.dynamic.methods import Mapper, corrected, pooled, tared
from benchmarks.dynamic.synthetic import NOISE, Case
from benchmarks.full_body.filters import (
    CAUSAL,
    COLOURS,
    DYNAMIC,
    FCDI,
    FDMC,
    FDMC_PER_FRAME,
    FDMC_PRINTED,
)
from benchmarks.references import rms
from benchmarks.thesis_report.contents import CANNOT_BE_HAD, OPEN, Band, Claim, Findings, Row, Sheet, judged
from benchmarks.thesis_report.figures import Drawing, axes, labelled
from mbkf.conventions import Array
from mbkf.io.records import Capture
from mbkf.io.results import Reconstruction
from mbkf.io.truth import Truth
from mbkf.numerics.threads import single_threaded
from mbkf.synthesis.person import body_of
from mbkf.trial.synth import synthesise

SECONDS, SEEDS = 2.4, 2
"""One squat of each of so many persons."""

SLIDE_M = 0.02
"""At the bottom of the squat."""

SEGMENTS = ("pelvis", "right_thigh", "right_shank", "right_foot", "right_toes")
"""The left leg is the right one's mirror image."""

KNEE = "knee_angle_r"
DIRECTIONS = ("forwards", "to the left", "upwards")
"""Names of a segment's axes x, y, z as one stands."""

WORST = 8
"""FDMC costs as much as all others together, and so it is run for so many markers only."""

MORE_SENSITIVE = 1.2
"""A filter that follows a marker this many times as far as another one is more sensitive."""

NOTABLE = 0.1
"""Ratios of changes are taken where one of both is this share of the largest change."""

QUANTITIES = {"angle_deg": "knee angle (°)", "torque_nm": "knee torque (N m)", "residual_n": "residual (N)"}

_HEIGHT = 2
_MM = 1e3
_EVERYWHERE, _WORST_ONLY = (FCDI, DYNAMIC), (FDMC_PRINTED, FDMC_PER_FRAME, FDMC)


class Slide(NamedTuple):
    """A ``marker`` that slides along an ``axis`` of its segment: 0, 1, 2 for x, y, z."""

    marker: str
    axis: int


QUICK_SLIDES = (Slide("RASI", 2), Slide("RANK", 0))


class Change(NamedTuple):
    """RMS changes by a slide.

    Attributes:
        angle_deg: Of the knee's flexion.
        torque_nm: Of its torque.
        residual_n: Of the residual force at the pelvis under the measured plates.
    """

    angle_deg: float
    torque_nm: float
    residual_n: float


@dataclass(frozen=True)
class Sensitivities:
    """The ``changes`` by slide, the most followed one first, and filter, pooled over ``persons``."""

    changes: Mapping[Slide, Mapping[str, Change]]
    persons: int

    @property
    def markers(self) -> list[Slide]:
        """Every marker once, with the slide that FCDI's or the dynamic filter's knee angle follows farthest."""
        first: dict[str, Slide] = {}
        for slide in self.changes:
            first.setdefault(slide.marker, slide)
        return list(first.values())

    def ratios(self, name: str, quantity: str) -> dict[Slide, float]:
        """A filter's changes over FCDI's, for all slides that move one of both by a good part of what moves it most.

        Args:
            name: The filter.
            quantity: Field of :class:`Change`.
        """
        both = {
            slide: (getattr(found[name], quantity), getattr(found[FCDI], quantity))
            for slide, found in self.changes.items()
            if name in found
        }
        least = NOTABLE * max(max(pair) for pair in both.values())
        return {slide: own / other for slide, (own, other) in both.items() if max(own, other) >= least}

    def worst(self, name: str, quantity: str) -> tuple[Slide, float]:
        """The slide that changes a filter's quantity most, and that change.

        Args:
            name: The filter.
            quantity: Field of :class:`Change`.
        """
        known = {
            slide: getattr(found[name], quantity) for slide, found in self.changes.items() if name in found
        }
        slide = max(known, key=lambda one: known[one])
        return slide, known[slide]


def make_squat(seed: int) -> Case:
    """One squat of a random person, with marker positions corrected on it."""
    with single_threaded():
        subject, made = synthesise("squat", seconds=SECONDS, seed=seed, settings=NOISE)
    capture = tared(made.trial)
    return Case("squat", seed, subject, corrected(subject, capture), capture, made.truth)


def depth(truth: Truth) -> Array:
    """(T,) how deep the squat is, by the height of the pelvis: 0 standing, 1 at the bottom."""
    height = truth.q[:, _HEIGHT]
    share: Array = (height.max() - height) / np.ptp(height)
    return share


def slid(case: Case, slide: Slide, slide_m: float = SLIDE_M) -> Capture:
    """The capture with one marker slid in its true segment's frame, by ``slide_m`` at the bottom of the squat.

    Args:
        case: The trial.
        slide: The marker and its direction.
        slide_m: How far.
    """
    model, markers = body_of(case.given), case.capture.markers
    segment = next(marker.segment for marker in case.given.markers if marker.name == slide.marker)
    joint = model.joint(segment).joint_id
    axis = np.array([model.placements(q)[0][joint][:, slide.axis] for q in case.truth.q])
    positions = markers.positions_m.copy()
    positions[:, markers.names.index(slide.marker)] += slide_m * depth(case.truth)[:, None] * axis
    return replace(case.capture, markers=replace(markers, positions_m=positions))


def changes(key: tuple[Case, str, Sequence[Slide]]) -> list[Change]:
    """What each slide changes of a trial's estimate by the filter of that name."""
    case, name, slides = key
    method = CAUSAL[name]
    usual = method.run(case.capture, case.subject)
    return [change(usual, method.run(slid(case, slide), case.subject)) for slide in slides]


def change(usual: Reconstruction, found: Reconstruction) -> Change:
    """RMS differences of two estimates.

    Args:
        usual: Of the trial as it is.
        found: Of the same trial with a slid marker.
    """
    knee = usual.coordinate_names.index(KNEE)
    return Change(
        float(np.rad2deg(rms(found.angles[:, knee] - usual.angles[:, knee]))),
        rms(found.moments[:, knee] - usual.moments[:, knee]),
        rms(found.residual_force_n - usual.residual_force_n),
    )


def measure_single_markers(mapper: Mapper, *, quick: bool) -> Sensitivities:
    """Slides every marker; FDMC follows only the worst slides of the worst markers.

    Args:
        mapper: Runs a function on many items, in turn or on several processes.
        quick: Whether two slides on one person will do, without FDMC.
    """
    cases = mapper(make_squat, range(1 if quick else SEEDS))
    slides = list(QUICK_SLIDES) if quick else every_slide(cases[0])
    by_slide = _measured(cases, slides, _EVERYWHERE, mapper)
    slides.sort(key=lambda slide: max(found.angle_deg for found in by_slide[slide].values()), reverse=True)
    found = Sensitivities({slide: by_slide[slide] for slide in slides}, len(cases))
    if not quick:
        worst = _measured(cases, found.markers[:WORST], _WORST_ONLY, mapper)
        both = {slide: {**known, **worst.get(slide, {})} for slide, known in found.changes.items()}
        found = replace(found, changes=both)
    return found


def every_slide(case: Case) -> list[Slide]:
    """Every marker of :data:`SEGMENTS` in every direction."""
    names = [marker.name for marker in case.given.markers if marker.segment in SEGMENTS]
    return [Slide(name, axis) for name in names for axis in range(3)]


def _measured(
    cases: Sequence[Case], slides: Sequence[Slide], names: Sequence[str], mapper: Mapper
) -> dict[Slide, dict[str, Change]]:
    keys = [(case, name, slides) for name in names for case in cases]
    found = iter(mapper(changes, keys))
    by_name = {name: [next(found) for _ in cases] for name in names}
    return {
        slide: {name: _pooled(one[k] for one in by_name[name]) for name in names}
        for k, slide in enumerate(slides)
    }


def _pooled(found: Iterable[Change]) -> Change:
    return Change(*(pooled(values) for values in zip(*found, strict=True)))


def single_marker_findings(found: Sensitivities) -> Findings:
    """Tables, bands and the thesis's statement.

    Args:
        found: What was measured.
    """
    bands = [
        Band(
            "a sliding marker",
            f"worst change of the knee's {word}, dynamic / FCDI",
            found.worst(DYNAMIC, quantity)[1] / found.worst(FCDI, quantity)[1],
            -OPEN,
            1.0,
        )
        for quantity, word in (("angle_deg", "angle"), ("torque_nm", "torque"))
    ]
    return Findings(bands, [_marker_sheet(found), _filter_sheet(found)], [_claim(found)])


def _names(found: Sensitivities) -> list[str]:
    """Filters that were run, in their usual order."""
    return [name for name in CAUSAL if any(name in known for known in found.changes.values())]


def _words(slide: Slide) -> str:
    return f"{slide.marker} {DIRECTIONS[slide.axis]}"


def _marker_sheet(found: Sensitivities) -> Sheet:
    names = _names(found)
    rows: list[Row] = []
    for slide in found.markers:
        cells: list[str | float] = []
        for quantity in ("angle_deg", "torque_nm"):
            known = {name: getattr(one, quantity) for name, one in found.changes[slide].items()}
            cells += [known.get(name, "–") for name in names] + [known[DYNAMIC] / known[FCDI]]
        rows.append((slide.marker, DIRECTIONS[slide.axis], *cells))
    columns = tuple(
        f"{QUANTITIES[quantity]}: {name}"
        for quantity in ("angle_deg", "torque_nm")
        for name in (*names, "dynamic / FCDI")
    )
    note = (
        f"RMS change over a squat (persons: {found.persons}) while one marker of the right leg or the pelvis slides, "
        f"{_MM * SLIDE_M:.0f} mm at the bottom, in the direction of its segment that the knee angle of FCDI or "
        f"dynamic follows farthest. FDMC is run for the {WORST} worst."
    )
    return Sheet(
        "single_markers", "A sliding marker, worst first", ("marker", "slides", *columns), tuple(rows), note
    )


def _filter_sheet(found: Sensitivities) -> Sheet:
    columns, rows = ["filter", "slides"], []
    for title in QUANTITIES.values():
        columns += [f"{title}: worst", "by", "over FCDI, median", "over FCDI, largest", "at"]
    for name in _names(found):
        cells: list[str | float] = [name, float(sum(name in known for known in found.changes.values()))]
        for quantity in QUANTITIES:
            slide, worst = found.worst(name, quantity)
            at, median, largest = _against_fcdi(found, name, quantity)
            cells += [worst, _words(slide), median, largest, _words(at)]
        rows.append(tuple(cells))
    note = (
        "Ratios are of the same slides, where they change anything: by a tenth of the largest change or more. The "
        "residual is that under the measured plates; the dynamic filter keeps it near zero, whatever a marker does. "
        "FDMC's worst are those of fewer slides."
    )
    return Sheet(
        "single_markers_filters",
        "A sliding marker: what each filter follows",
        tuple(columns),
        tuple(rows),
        note,
    )


def _against_fcdi(found: Sensitivities, name: str, quantity: str) -> tuple[Slide, float, float]:
    """The slide with the largest ratio to FCDI, the median ratio and the largest."""
    ratios = found.ratios(name, quantity)
    at = max(ratios, key=lambda slide: ratios[slide])
    return at, float(np.median(list(ratios.values()))), ratios[at]


def _claim(found: Sensitivities) -> Claim:
    compared = {
        name: [_against_fcdi(found, name, quantity) for quantity in ("angle_deg", "torque_nm")]
        for name in _names(found)[1:]
    }
    verdicts = {
        name: _more_sensitive(max(one[1] for one in both), max(one[2] for one in both))
        for name, both in compared.items()
    }
    (angle_at, angle), (torque_at, torque) = (found.worst(FCDI, one) for one in ("angle_deg", "torque_nm"))
    usual = (
        f"{_MM * SLIDE_M:.0f} mm change FCDI's knee by up to {angle:.2f}° ({_words(angle_at)}) and {torque:.2f} N m "
        f"({_words(torque_at)}); over FCDI's changes by the same slides:"
    )
    texts = []
    for name, both in compared.items():
        parts = (
            f"{word} {median:.2f} in the median, at most {largest:.2f} ({_words(at)})"
            for word, (at, median, largest) in zip(("angle", "torque"), both, strict=True)
        )
        texts.append(f"{name} ({verdicts[name]}): {', '.join(parts)}")
    theirs = [verdicts[name] for name in (FDMC_PRINTED, FDMC_PER_FRAME) if name in verdicts]
    unless = "" if theirs else "; the thesis's filter was not run"
    return Claim(
        "4.2, squats",
        "The multibody model with dynamics is very sensitive to the displacement of a single marker (its marker 15), "
        "the kinematic filter less.",
        f"{usual} {'; '.join(texts)}{unless}",
        judged("holds" in theirs, "partly" in theirs) if theirs else CANNOT_BE_HAD,
    )


def _more_sensitive(median: float, largest: float) -> str:
    """Whether a filter is more sensitive than FCDI: for most slides, for some, or for none."""
    return judged(median > MORE_SENSITIVE, largest > MORE_SENSITIVE)


def single_marker_drawing(found: Sensitivities) -> Drawing:
    """The worst markers: what every filter's knee angle and torque follow."""
    slides, names = found.markers[:WORST], _names(found)
    figure, pair = axes(1, 2, height=0.8 + 0.5 * len(slides))
    place, height = np.arange(len(slides)), 0.8 / len(names)
    for one, quantity in zip(pair, ("angle_deg", "torque_nm"), strict=True):
        for k, name in enumerate(names):
            values = [getattr(found.changes[slide][name], quantity) for slide in slides]
            one.barh(place + (k + 0.5) * height - 0.4, values, height, color=COLOURS[name], label=name)
        one.set_yticks(place, [_words(slide) for slide in slides] if one is pair[0] else [])
        one.set_axisbelow(True)
        one.invert_yaxis()
        labelled(one, f"change of the {QUANTITIES[quantity]}", "")
    handles = pair[0].get_legend_handles_labels()
    figure.legend(*handles, loc="outside upper right", ncols=len(names), fontsize=8, frameon=False)
    title = "Squat: one marker slides, and how far each filter follows"
    note = f"RMS over the squat; the marker slides by {_MM * SLIDE_M:.0f} mm at the bottom, in its worst direction."
    return Drawing("own", title, figure, note)
