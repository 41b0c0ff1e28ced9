"""Chart of every marker in every frame (seen, refused, hidden on purpose, not seen), with each marker's error."""

from __future__ import annotations

from html import escape
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array
from mbkf.io.results import Reconstruction
from mbkf.numerics.runs import runs
from mbkf.viz.svg import number, ticks

SEEN, UNSEEN, REFUSED, HIDDEN, LOST = range(5)
CLASSES = ("seen", "unseen", "refused", "hidden", "lost")
LABELS = ("seen and used", "not seen", "refused by the gate", "hidden on purpose", "body not tracked")

ROW, NAME, CHART, BAR, RIGHT = 13.0, 118.0, 640.0, 120.0, 130.0
TOP = 30.0
GHOSTS = 34.0
"""Heights and widths of the drawing."""


def states(r: Reconstruction) -> NDArray[np.int64]:
    """(T, M) state of every marker in every frame: an index of :data:`CLASSES`."""
    found = np.full(r.hidden.shape, SEEN)
    found[r.rejected] = REFUSED
    found[np.isnan(r.measured_m).any(axis=2)] = UNSEEN
    found[r.hidden] = HIDDEN
    found[~r.tracked] = LOST
    return found


def marker_errors_mm(r: Reconstruction) -> tuple[Array, Array]:
    """(M,) RMS and (M,) largest distance of measured and reconstructed markers, mm, where seen and tracked."""
    distance = 1e3 * np.linalg.norm(r.measured_m - r.predicted_m, axis=2)
    counted = r.present & r.tracked[:, None]
    squares = np.where(counted, distance**2, 0.0).sum(axis=0)
    count = counted.sum(axis=0)
    rms = np.sqrt(np.where(count, squares / np.maximum(count, 1), np.nan))
    largest = np.where(counted, distance, -np.inf).max(axis=0, initial=-np.inf)
    return rms, np.where(count, largest, np.nan)


def longest_gap_s(r: Reconstruction) -> Array:
    """(M,) longest time that a marker was not seen, or hidden, s."""
    longest = np.zeros(len(r.marker_names))
    for m, absent in enumerate((~r.present).T):
        longest[m] = max((end - first for first, end in runs(absent)), default=0) / r.rate_hz
    return longest


def marker_chart(r: Reconstruction, ghosts: Array | None = None) -> str:
    """The chart as an SVG element.

    Args:
        r: The reconstruction.
        ghosts: (T,) count of points without a marker that were dropped in each frame; None where not known.
    """
    found = states(r)
    rms, largest = marker_errors_mm(r)
    first, last = (float(r.times_s[0]), float(r.times_s[-1])) if r.frames else (0.0, 1.0)
    per_frame = CHART / max(r.frames, 1)
    top = TOP + (GHOSTS if ghosts is not None else 0.0)
    bottom = top + ROW * len(r.marker_names)
    missing = 100.0 * (~r.present).sum(axis=0) / max(r.frames, 1)
    scale = BAR / max(float(np.nanmax(largest, initial=1.0)), 1.0)
    parts = [_headings()]
    if ghosts is not None:
        parts.append(_ghosts(ghosts, per_frame))
    for m, name in enumerate(r.marker_names):
        y = top + ROW * m
        parts.append(
            f'<text class="name" translate="no" x="{NAME - 6:g}" y="{y + 9.5:g}">{escape(name)}</text>'
        )
        parts.append(
            f'<rect class="seen" x="{NAME:g}" y="{y + 1:g}" width="{CHART:g}" height="{ROW - 2:g}"/>'
        )
        parts += _stretches(found[:, m], y, per_frame)
        parts.append(_error(rms[m], largest[m], missing[m], y, scale))
    found_ticks, digits = ticks(first, max(last, first + 1e-3), 8)
    for value in found_ticks:
        x = NAME + (value - first) * r.rate_hz * per_frame
        unit = " s" if value == found_ticks[-1] else ""
        parts.append(f'<text class="x" x="{x:.1f}" y="{bottom + 13:g}">{number(value, digits)}{unit}</text>')
    width = NAME + CHART + 14 + BAR + RIGHT
    return (
        f'<svg class="markers" viewBox="0 0 {width:g} {bottom + 18:g}" role="img" '
        f'aria-label="State of every marker in every frame">{"".join(parts)}</svg>'
    )


def _headings() -> str:
    x = NAME + CHART + 14
    return (
        f'<text class="head" x="{NAME:g}" y="14">frames in which each marker was seen</text>'
        f'<text class="head" x="{x:g}" y="14">RMS and largest error, mm</text>'
        f'<text class="head end" x="{x + BAR + RIGHT:g}" y="14">missing</text>'
    )


def _stretches(state: NDArray[np.int64], y: float, per_frame: float) -> list[str]:
    edges = np.flatnonzero(np.diff(np.concatenate([[SEEN], state, [SEEN]])))
    parts = []
    for a, b in pairwise(edges):
        if state[a] != SEEN:
            width = max((b - a) * per_frame, 0.8)
            parts.append(
                f'<rect class="{CLASSES[state[a]]}" x="{NAME + a * per_frame:.1f}" y="{y + 1:g}" '
                f'width="{width:.1f}" height="{ROW - 2:g}"/>'
            )
    return parts


def _error(rms: float, largest: float, missing: float, y: float, scale: float) -> str:
    x = NAME + CHART + 14
    share = f"{missing:.1f} %" if missing else ""
    text = f'<text class="share" x="{x + BAR + RIGHT:g}" y="{y + 9.5:g}">{share}</text>'
    if not np.isfinite(rms):
        return text
    return (
        f'<path class="reach" d="M{x:g} {y + ROW / 2:g}h{scale * largest:.1f}"/>'
        f'<rect class="rms" x="{x:g}" y="{y + 3:g}" width="{scale * rms:.1f}" height="{ROW - 6:g}"/>'
        f'<text class="value" x="{x + scale * largest + 5:.1f}" y="{y + 9.5:g}">{rms:.1f} / {largest:.1f}</text>'
        f"{text}"
    )


def _ghosts(ghosts: Array, per_frame: float) -> str:
    """Ghost points dropped in every frame, as a step curve above the markers."""
    most = max(float(ghosts.max(initial=0.0)), 1.0)
    base, high = TOP + GHOSTS - 8.0, GHOSTS - 14.0
    changes = [0, *(np.flatnonzero(np.diff(ghosts)) + 1)] if len(ghosts) else []
    d = f"M{NAME:g} {base:g}"
    for t in changes:
        d += f"H{NAME + t * per_frame:.1f}V{base - high * ghosts[t] / most:.1f}"
    d += f"H{NAME + CHART:g}V{base:g}Z"
    return (
        f'<path class="ghosts" d="{d}"/><text class="name" x="{NAME - 6:g}" y="{base - 2:g}">ghosts dropped</text>'
        f'<text class="value" x="{NAME + CHART + 14:g}" y="{base - 2:g}">at most {most:.0f} a frame, '
        f"{ghosts.sum():.0f} in all</text>"
    )
