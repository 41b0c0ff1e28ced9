"""The page of real truth: tables of agreement with the references, and the judges that no body model enters."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np

from benchmarks.checks import Check
from benchmarks.real_truth.before import stated
from benchmarks.real_truth.followed import STATIC, Compared
from benchmarks.real_truth.persons import PERSONS, STANDING
from benchmarks.real_truth.rows import (
    FLEXIONS,
    MOST_SHIFT_DEG,
    agreement,
    hip_shifts,
    median_varying,
    pooled_cover,
)

PAGE = "real_truth.md"

CAUSES = Path(__file__).with_name("causes.md")
"""Causes of what the tables show, each with its measurement; written after reading them."""

UPPER = ("lumbar_extension", "lumbar_bending", "lumbar_rotation", "arm_flex", "elbow_flex")

NAMES = {"hip_flexion": "hip", "knee_angle": "knee", "ankle_angle": "ankle"}

INTRODUCTION = (
    "Real captures that carry angles or moments of another program, or that show the answer by themselves. "
    "`python -m benchmarks.real_truth --page docs` makes this page from the public captures, with the numbers as "
    "measured; `python -m benchmarks real_truth` holds them to their bounds. Skin and joint "
    "centres were not set on these persons, noise of the filters on some ({doc}`tuning`). "
    "No person of this collection has a reference for two different movements beside standing (walk and squat, say); "
    "persons made with OpenSim have ({doc}`calibration`).",
    "**A reference is wrong by some degrees, too.** OpenSim's inverse kinematics puts its zero where the analyst's "
    "model and marker places have it; Plug-in Gait's axes follow the skin under single markers; the RBDL model of the "
    "lifts leaves its markers 11 mm from the measured ones in the mean, 50 mm at the shoulders. A constant difference "
    "is therefore no error of either; a change of it between trials of one person is. Shares of the reference inside "
    "our 95 % intervals count the reference as exact, so they are lower than the cover of the truth.",
    "Files with Plug-in Gait's angles are read with `--angles pig`, the others in the body's own axes "
    "({ref}`angle-readings`). Persons are scaled as `mbkf batch` does it (standing and the trials that help), in the "
    "tables called *standing* from the standing trial alone. Moments count in frames whose loads are known and in "
    "which a plate of its own reads the foot; Plug-in Gait's have the opposite sign.",
)  # fmt: skip


def write_page(folder: Path, by_scaling: Mapping[str, Sequence[Compared]], before: Sequence[Check]) -> None:
    """Writes the page.

    Args:
        folder: Where to.
        by_scaling: Trials by way of scaling.
        before: Rows of markers against the tree before.
    """
    (folder / PAGE).write_text("\n".join(page(by_scaling, before)) + "\n", encoding="utf-8")


def page(by_scaling: Mapping[str, Sequence[Compared]], before: Sequence[Check]) -> Iterator[str]:
    """Lines of the page.

    Args:
        by_scaling: Trials by way of scaling.
        before: Rows of markers against the tree before.
    """
    yield "# Real truth"
    yield ""
    for paragraph in INTRODUCTION:
        yield from (paragraph, "")
    yield from _shifts(by_scaling)
    for scaling, found in by_scaling.items():
        yield from _angles(scaling, found)
    session = next(found for scaling, found in by_scaling.items() if scaling != STATIC)
    yield from _upper(session)
    yield from _moments(session)
    yield from _judged(by_scaling)
    yield from _before(before, session, by_scaling[STATIC])


def _shifts(by_scaling: Mapping[str, Sequence[Compared]]) -> Iterator[str]:
    yield "## Hip flexion between trials of one person"
    yield ""
    yield (
        f"Standard deviation and range of the mean difference, the worse side (bound {MOST_SHIFT_DEG:g}° for the "
        "range), degrees."
    )
    yield ""
    yield "| person | trials | " + " | ".join(_title(scaling) for scaling in by_scaling) + " |"
    yield "|---|---|" + "---|" * len(by_scaling)
    trials = {person.name: ", ".join(one.name for one in person.trials) for person in PERSONS}
    shifts = [hip_shifts(found) for found in by_scaling.values()]
    for person in shifts[0]:
        cells = [f"{held[person][1]:.1f}, {held[person][2]:.1f}" for held in shifts]
        yield f"| {person} | {trials[person]} | {' | '.join(cells)} |"
    yield ""


def _angles(scaling: str, found: Sequence[Compared]) -> Iterator[str]:
    yield f"## Hip, knee and ankle: {_title(scaling)}"
    yield ""
    yield (
        "Mean difference right and left; the larger RMS without the mean, smaller correlation; share of the reference "
        "inside the 95 % interval, and of both without their means. Degrees."
    )
    yield ""
    yield "| person, trial (reference) | hip | knee | ankle |"
    yield "|---|---|---|---|"
    for one in found:
        cells = [_cell(one, "angle", name) for name in FLEXIONS]
        yield f"| {one.person}, {one.trial} ({one.kind}) | {' | '.join(cells)} |"
    yield ""
    covers = []
    for kind in dict.fromkeys(one.kind for one in found):
        whole, varying = pooled_cover(found, kind)
        covers.append(f"{kind} {100 * whole:.0f} and {100 * varying:.0f} %")
    yield f"Together, standing left out, inside and inside without means: {'; '.join(covers)}."
    yield ""


def _upper(found: Sequence[Compared]) -> Iterator[str]:
    yield "## Trunk and arms"
    yield ""
    yield "As above, from the session."
    yield ""
    yield "| person, trial | " + " | ".join(name.replace("_", " ") for name in UPPER) + " |"
    yield "|---|" + "---|" * len(UPPER)
    for one in found:
        cells = [_cell(one, "angle", name) for name in UPPER]
        if any(cells):
            yield f"| {one.person}, {one.trial} | {' | '.join(cells)} |"
    yield ""


def _moments(found: Sequence[Compared]) -> Iterator[str]:
    yield "## Moments"
    yield ""
    yield "Mean difference by side; RMS without the mean, correlation; shares inside. N m/kg, from the session."
    yield ""
    yield "| person, trial (reference) | hip | knee | ankle |"
    yield "|---|---|---|---|"
    for one in found:
        cells = [_cell(one, "moment", name) for name in FLEXIONS]
        if any(cells):
            yield f"| {one.person}, {one.trial} ({one.kind}) | {' | '.join(cells)} |"
    yield ""


def _judged(by_scaling: Mapping[str, Sequence[Compared]]) -> Iterator[str]:
    yield "## Who is right, where it can be known"
    yield ""
    yield (
        "**Tilt of the pelvis.** The line from sacrum or PSIS to the ASIS shows by three or four markers how far the "
        "pelvis tilts between standing and a trial; no body model enters, and no reference. Change of our pelvis minus "
        f"that of the line (bound {MOST_SHIFT_DEG:g}°), degrees. In the lifts the trunk bends by 90° and the skin "
        "over the ASIS folds: there the line itself errs."
    )
    yield ""
    yield "| person, trial | line | " + " | ".join(_title(scaling) for scaling in by_scaling) + " |"
    yield "|---|---|" + "---|" * len(by_scaling)
    for trials in zip(*by_scaling.values(), strict=True):
        one = trials[0]
        if np.isfinite(one.line_deg) and one.trial != STANDING:
            cells = [f"{each.tilt_deg - each.line_deg:+.1f}" for each in trials]
            yield f"| {one.person}, {one.trial} | {one.line_deg:+.1f} | {' | '.join(cells)} |"
    yield ""
    yield from _newton(by_scaling)
    yield from _hips(by_scaling)
    yield CAUSES.read_text(encoding="utf-8")


def _hips(by_scaling: Mapping[str, Sequence[Compared]]) -> Iterator[str]:
    yield (
        "**Hip centres.** The clinic's walk stores functional hip centres by three methods. Distance of ours from "
        "their mean, of theirs from it, mm (bound 15 for *standing*; in the session these points are markers that "
        "scaling sees, too)."
    )
    yield ""
    yield "| person, trial, side | theirs | " + " | ".join(_title(scaling) for scaling in by_scaling) + " |"
    yield "|---|---|" + "---|" * len(by_scaling)
    for trials in zip(*by_scaling.values(), strict=True):
        one = trials[0]
        for side, (_, apart) in one.hips_mm.items():
            cells = [f"{each.hips_mm[side][0]:.0f}" for each in trials]
            yield f"| {one.person}, {one.trial}, {side} | {apart:.0f} | {' | '.join(cells)} |"
    yield ""


def _newton(by_scaling: Mapping[str, Sequence[Compared]]) -> Iterator[str]:
    yield (
        "**Newton's law.** Force that inverse dynamics leaves at the pelvis, RMS in N, of our marker filter (before "
        "any filter imposes the law) and of the reference. Rajagopal's coordinates were adjusted for a small residual."
    )
    yield ""
    yield "| person, trial | reference | " + " | ".join(_title(scaling) for scaling in by_scaling) + " |"
    yield "|---|---|" + "---|" * len(by_scaling)
    for trials in zip(*by_scaling.values(), strict=True):
        theirs = trials[0].residual_n[1]
        if np.isfinite(theirs):
            cells = [f"{each.residual_n[0]:.0f}" for each in trials]
            yield f"| {trials[0].person}, {trials[0].trial} | {theirs:.0f} | {' | '.join(cells)} |"
    yield ""


def _before(
    rows: Sequence[Check], session: Sequence[Compared], standing: Sequence[Compared]
) -> Iterator[str]:
    yield "## Before and now"
    yield ""
    yield (
        "Angles: median over all trials but standing of the RMS without the mean against the references, larger of "
        "both sides, degrees."
    )
    yield ""
    yield "| | before | standing | session |"
    yield "|---|---|---|---|"
    for coordinate, value in stated("varying_deg").items():
        cells = [f"{median_varying(found, coordinate):.2f}" for found in (standing, session)]
        yield f"| {NAMES[coordinate]} | {value:.2f} | {' | '.join(cells)} |"
    yield ""
    yield (
        "Markers: RMS distance of measured and reconstructed markers, over that of commit ca5a470, before skin and "
        "joint centres were in the model (bound 1.15); default filter, scaled from standing, or from the trial without "
        "one."
    )
    yield ""
    yield "| capture | ratio | capture | ratio | capture | ratio |"
    yield "|---|---|---|---|---|---|"
    cells = [f"{row.name.split(':')[0]} | {row.value:.2f}" for row in rows]
    cells += [" | "] * (-len(cells) % 3)
    for k in range(0, len(cells), 3):
        yield f"| {' | '.join(cells[k : k + 3])} |"
    yield ""


def _cell(one: Compared, group: str, coordinate: str) -> str:
    found = agreement(one, group, coordinate)
    if found is None:
        return ""
    digits = 1 if group == "angle" else 2
    offsets = ", ".join(f"{offset:+.{digits}f}" for offset in found.offsets)
    if one.trial == STANDING:
        return offsets
    shares = f"{100 * found.cover:.0f}, {100 * found.varying_cover:.0f} %"
    return f"{offsets}; {found.varying:.{digits}f}, {found.r:.2f}; {shares}"


def _title(scaling: str) -> str:
    return "standing" if scaling == STATIC else "session"
