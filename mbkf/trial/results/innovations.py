"""Normalised innovations of a trial: near one by kind of reading where it is coherent; remarks on those outside."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from mbkf.conventions import READING_KINDS, Array, BoolArray
from mbkf.io.findings import Finding
from mbkf.io.results import Reconstruction
from mbkf.numerics.runs import runs
from mbkf.trial.checks.newton import FORCE, MOMENT

SETTLING_S = 0.5
"""Innovations within this time after the start are left out, while the filter settles."""

BAND = (0.7, 1.4)
"""Normalised innovation squared per reading of a trial whose readings err as they did just before."""

BEFORE = "before_correction"
"""Newton's law by the motion of markers alone, before a filter makes it hold, beside :data:`READING_KINDS`."""

STRETCH_S, STRETCH_NIS = 0.5, 3.0
"""A stretch of this length with more is reported; at most 2.7 in the public captures."""

MARKER_NIS, MARKER_S = 2.0, 0.5
"""A marker with more, seen for this long at least, is reported; three markers of public captures have 2.1 to 2.6."""

MOST_NAMED = 4
"""So many markers or stretches are named."""

KIND_WORDS = {"markers": "markers", "plates": "plates", "law": "Newton's law", "other": "other instruments"}


def per_reading(r: Reconstruction) -> float | None:
    """Mean over settled frames of the normalised innovation squared per reading."""
    counted = settled(r) & (r.nis_readings > 0) & np.isfinite(r.nis)
    if not counted.any():
        return None
    return float((r.nis[counted] / r.nis_readings[counted]).mean())


def by_kind(r: Reconstruction) -> dict[str, float]:
    """Normalised innovation squared per reading of each kind that reads, and of Newton's law before correction.

    The latter is the mean square of the force and moment that plates lack, in units of the share that soft tissue and
    segments' masses explain (:mod:`mbkf.trial.checks.newton`).
    """
    found: dict[str, float] = {}
    if r.nis_by_kind is not None and r.nis_readings_by_kind is not None:
        counted = settled(r) & np.isfinite(r.nis_by_kind).all(axis=1)
        squared, readings = (x[counted].sum(axis=0) for x in (r.nis_by_kind, r.nis_readings_by_kind))
        found = {kind: float(squared[k] / readings[k]) for k, kind in enumerate(READING_KINDS) if readings[k]}
    before = before_correction(r.checks)
    return found if before is None else found | {BEFORE: before}


def before_correction(checks: Sequence[Finding]) -> float | None:
    """Mean square of the force and moment that plates lack over its expectation; None: not judged."""
    squared = [
        (one.value / one.expected_sd) ** 2
        for one in checks
        if one.name in (FORCE, MOMENT) and one.value is not None and one.expected_sd
    ]
    return float(np.mean(squared)) if squared else None


def marker_noise_mm(r: Reconstruction) -> dict[str, float | None]:
    """Root mean square of the spread of one reading of each marker, per coordinate, as its innovations show it."""
    if r.marker_spread_m is None:
        return {}
    seen = np.where(settled(r)[:, None] & r.present, r.marker_spread_m, np.nan)
    counts = np.isfinite(seen).sum(axis=0)
    mean = np.nansum(seen**2, axis=0) / np.maximum(counts, 1)
    return {
        name: float(1e3 * np.sqrt(mean[m])) if counts[m] else None for m, name in enumerate(r.marker_names)
    }


def remarks(r: Reconstruction) -> tuple[str, ...]:
    """Remarks on innovations outside their band: of the markers as a whole, in stretches, and of single markers."""
    return tuple(_remarks(r))


def _remarks(r: Reconstruction) -> Iterator[str]:
    markers = by_kind(r).get("markers")
    if markers is not None and markers > BAND[1]:
        yield (
            f"innovations of markers: {markers:.1f} per reading (a coherent trial has {BAND[0]:g} to {BAND[1]:g}); "
            "they err more than skin does, or change from moment to moment: see names, gaps, and the body's scaling"
        )
    stretches = [f"{a:.2f}–{b:.2f} s ({kind} {nis:.1f})" for a, b, nis, kind in _stretches(r)]
    if stretches:
        more = " …" if len(stretches) > MOST_NAMED else ""
        yield (
            f"innovations above {STRETCH_NIS:g} per reading for {STRETCH_S:g} s, where readings suddenly err more than "
            f"before: {', '.join(stretches[:MOST_NAMED])}{more}"
        )
    yield from _single(r)


def _single(r: Reconstruction) -> Iterator[str]:
    if r.marker_nis is None:
        return
    used = np.isfinite(r.marker_nis) & settled(r)[:, None]
    counts = used.sum(axis=0)
    mean = np.where(used, r.marker_nis, 0.0).sum(axis=0) / np.maximum(counts, 1)
    odd = np.flatnonzero((mean > MARKER_NIS) & (counts >= MARKER_S * r.rate_hz))
    if len(odd):
        odd = odd[np.argsort(-mean[odd])]
        names = ", ".join(f"{r.marker_names[m]} ({mean[m]:.1f})" for m in odd[:MOST_NAMED])
        more = " …" if len(odd) > MOST_NAMED else ""
        yield (
            f"markers whose innovations are more than {MARKER_NIS:g} per reading: {names}{more}; they move on their "
            "segment as skin does not, or sit elsewhere than the subject file says"
        )


def _stretches(r: Reconstruction) -> Iterator[tuple[float, float, float, str]]:
    """From and to, s, mean per reading and the kind that lies furthest off, of each stretch above its bound."""
    width = max(1, round(STRETCH_S * r.rate_hz))
    if r.nis_by_kind is None or r.nis_readings_by_kind is None or r.frames < width:
        return
    squared = np.where(settled(r)[:, None], np.nan_to_num(r.nis_by_kind), 0.0)
    readings = np.where(settled(r)[:, None], r.nis_readings_by_kind, 0)
    high: BoolArray = _moving(squared.sum(axis=1), width) > STRETCH_NIS * np.maximum(
        _moving(readings.sum(axis=1), width), 1.0
    )
    for opened, ended in runs(high):
        # Windows begin before the frames that raise them, and end after them.
        mine = slice(opened, ended + width - 1)
        raised = opened + np.flatnonzero(squared[mine].sum(axis=1) > STRETCH_NIS * readings[mine].sum(axis=1))
        begin, end = raised[0], raised[-1] + 1
        own, count = squared[begin:end].sum(axis=0), readings[begin:end].sum(axis=0)
        kind = int(np.argmax(own - count))
        nis = own[kind] / max(count[kind], 1)
        yield float(r.times_s[begin]), float(r.times_s[end - 1]), nis, KIND_WORDS[READING_KINDS[kind]]


def _moving(values: Array, width: int) -> Array:
    """(T − width + 1,) sums over windows."""
    total = np.concatenate([[0.0], np.cumsum(values)])
    return total[width:] - total[:-width]


def settled(r: Reconstruction) -> BoolArray:
    """(T,) frames in which innovations count, once the filter has settled."""
    return np.asarray(r.times_s >= (r.times_s[0] + SETTLING_S if r.frames else 0.0))
