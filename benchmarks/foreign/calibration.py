"""The calibration page: reliability curves, and tables of error, sharpness and cover by joint and by movement."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from benchmarks.foreign.errors import GROUPS, Judged, Series
from benchmarks.foreign.making.persons import CHOSEN_ON, SHOWN_ON
from benchmarks.foreign.score import LEVELS, AngleScore, angle_score, reliability, score
from benchmarks.thesis_report.figures import BLUE, GREEN, ORANGE, TRUTH, axes, labelled
from mbkf.conventions import Array

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FIGURE, PAGE = "reliability.svg", "calibration.md"

COLOURS = (BLUE, ORANGE, GREEN, TRUTH)
TITLES = {"legs": "hip, knee, ankle", "lumbar": "lumbar", "shoulder": "shoulder", "elbow": "elbow"}

OUTSIDE, MOST_FAILURES = 0.5, 15
"""A curve of which less than this share is inside its 95 % interval is a failure; so many are listed."""

Sets = Mapping[str, Sequence[Judged]]


def write_page(folder: Path, figures: Path, sets: Sets) -> None:
    """Writes the page and its figure.

    Args:
        folder: Folder of the page.
        figures: Folder of the figure.
        sets: Motions by set of persons; persons made from our own body last.
    """
    from matplotlib import rc_context

    with rc_context({"svg.hashsalt": "calibration"}):  # the same file from the same numbers
        drawn(sets).savefig(figures / FIGURE, metadata={"Date": None})
    (folder / PAGE).write_text("\n".join(page(sets)) + "\n", encoding="utf-8")


def drawn(sets: Sets) -> Figure:
    """Reliability curves: observed over nominal share, of total deviations above and of varying ones below.

    Args:
        sets: Motions by set of persons.
    """
    figure, panels = axes(2, len(GROUPS), height=2.1)
    for k, group in enumerate(GROUPS):
        for row, kind in enumerate(("total", "varying")):
            one = panels[row * len(GROUPS) + k]
            one.plot([0.0, 1.0], [0.0, 1.0], color="#9aa0a6", linewidth=0.8, linestyle=":")
            for (name, found), colour in zip(sets.items(), COLOURS, strict=False):
                shares = curve(found, group, varying=kind == "varying")
                one.plot(LEVELS, shares, color=colour, linewidth=1.3, marker=".", markersize=4, label=name)
            one.set_xlim(0.0, 1.0)
            one.set_ylim(0.0, 1.0)
            if row == 0:
                one.set_title(TITLES[group], fontsize=9)
            labelled(one, "nominal" if row else "", f"observed, {kind}" if k == 0 else "")
    handles, names = panels[0].get_legend_handles_labels()
    figure.legend(handles, names, fontsize=8, frameon=False, ncols=2, loc="outside lower center")
    return figure


def curve(found: Sequence[Judged], group: str, *, varying: bool) -> Array:
    """(L,) observed shares at the nominal levels.

    Args:
        found: Motions.
        group: Group of angles.
        varying: Of the part that varies, instead of the total.
    """
    series = [one for motion in found for one in motion.angles if one.group == group]
    error = np.concatenate([one.varying if varying else one.error for one in series])
    return reliability(error, np.concatenate([one.varying_sd if varying else one.sd for one in series]))


def page(sets: Sets) -> Iterator[str]:
    """Lines of the page.

    Args:
        sets: Motions by set of persons.
    """
    yield "# Calibration"
    yield ""
    yield "`python -m benchmarks.foreign --page docs --made DIR` makes this page, with the numbers as measured."
    yield ""
    yield (
        "A 95 % interval is calibrated where it holds the truth in 95 % of the samples, and sharp where it is narrow. "
        "Both are shown for persons made from bodies of OpenSim, whose joints are not placed and turned as ours, and "
        "for synthetic persons made from our own body, draws from the spreads that scaling and filters count on. "
        "All are scaled from standing, a walk and a squat and followed by the smoothed dynamic filter. Settings may "
        "have been chosen on the shared adult and child and on our "
        f"persons {_listed(CHOSEN_ON)}. The persons shown here as *own* are {_listed(SHOWN_ON)}: no setting was chosen "
        "on them. They have two models of skin that the filter does not know ({doc}`benchmarks`). {doc}`real_truth` "
        "has real captures beside outside references."
    )
    yield ""
    yield f"![Observed over nominal share of intervals by group of joints](../benchmarks/foreign/{FIGURE})"
    yield ""
    yield "Curves below the diagonal belong to standard deviations that are too small."
    yield ""
    yield "## By set of persons"
    yield ""
    yield "| persons | RMS ° | varying ° | median sd ° | inside 95 % | varying | calibration error |"
    yield "|---|---|---|---|---|---|---|"
    for name, found in sets.items():
        yield _row(name, angle_score(_all(found)))
    yield ""
    yield "## By joint"
    yield ""
    yield from _side_by_side("angle", sets, lambda one: one.name.removesuffix("_r").removesuffix("_l"))
    yield "## By movement"
    yield ""
    yield from _side_by_side("movement", sets, lambda one: one.motion)
    yield from _failures(sets)


def _listed(names: Sequence[str]) -> str:
    words = [name.replace("_", " ") for name in names]
    return ", ".join(words[:-1]) + " and " + words[-1]


def _all(found: Sequence[Judged]) -> list[Series]:
    return [one for motion in found for one in motion.angles]


def _side_by_side(title: str, sets: Sets, key: Callable[[Series], str]) -> Iterator[str]:
    """A table with a row for each key and a column for each set of persons."""
    held: dict[str, dict[str, list[Series]]] = defaultdict(lambda: defaultdict(list))
    for name, found in sets.items():
        for one in _all(found):
            held[key(one)][name].append(one)
    yield "RMS error and median standard deviation in degrees, share inside 95 % intervals, calibration error."
    yield ""
    yield f"| {title} | {' | '.join(sets)} |"
    yield "|---" * (1 + len(sets)) + "|"
    for label, by_set in held.items():
        cells = [_cell(angle_score(by_set[name])) if name in by_set else "" for name in sets]
        yield f"| {label.replace('_', ' ')} | {' | '.join(cells)} |"
    yield ""


def _cell(one: AngleScore) -> str:
    return f"{one.raw:.1f}, {one.sharpness:.1f}, {100.0 * one.cover:.0f} %, {one.calibration:.2f}"


def _row(name: str, one: AngleScore) -> str:
    shares = f"{100.0 * one.cover:.0f} % | {100.0 * one.varying_cover:.0f} %"
    return f"| {name} | {one.raw:.1f} | {one.varying:.1f} | {one.sharpness:.1f} | {shares} | {one.calibration:.2f} |"


def _failures(sets: Sets) -> Iterator[str]:
    yield "## Failures"
    yield ""
    curves = [(name, one) for name, found in sets.items() for one in _all(found)]
    outside = [(name, one, angle_score([one])) for name, one in curves]
    failed = sorted((held for held in outside if held[2].cover < OUTSIDE), key=lambda held: held[2].cover)
    yield (
        f"{len(failed)} of {len(curves)} curves have less than half of their samples inside the 95 % interval. "
        f"The first {min(len(failed), MOST_FAILURES)}, worst first:"
    )
    yield ""
    yield "| persons | person, movement | angle | inside | mean error ° | median sd ° |"
    yield "|---|---|---|---|---|---|"
    for name, one, scored in failed[:MOST_FAILURES]:
        inside, person = f"{100.0 * scored.cover:.0f} %", one.person.replace("_", " ")
        motion = one.motion.replace("_", " ")
        yield (
            f"| {name} | {person}, {motion} | `{one.name}` | {inside} | {one.offset:.1f} | {scored.sharpness:.1f} |"
        )
    yield ""
    yield "Largest change of the hip-flexion offset between the movements of one person:"
    yield ""
    yield "| persons | sd between movements ° | widest range ° | hip centre mm |"
    yield "|---|---|---|---|"
    for name, found in sets.items():
        held = [one for one in found if one.centres_m]
        if held:
            whole = score(held)
            shift, widest = whole.offsets.shift, whole.offsets.widest
            yield f"| {name} | {shift:.1f} | {widest:.1f} | {whole.centres_mm['hip']:.0f} |"
