"""Axes and place of each plate: the motion shows plates that are turned, mirrored or moved.

While a plate carries most of the load, its shear and its moment about the centre of mass have to be those that the
motion requires. The plate is tried in the eight ways in which a rectangle can be laid down, turned by quarters and
mirrored; a plate that lies beside its place by d lacks the moment d × f.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.io.findings import Finding, judged, judgement, not_judged
from mbkf.io.records import PlateReadings
from mbkf.trial.checks.evidence import Evidence

SHEAR_SHARE, MOMENT_M = 0.04, 0.025
"""Usual misfit of shear, in body weights, and of moment, in body weights times m (root of mean square per component in
public walks and runs: 0.02 to 0.07 and 0.01 to 0.03)."""

BOUND = 1.5
"""Misfit over that of another way to lay the plate down from which that one is right. The right way's is 0.1 to 0.6
times the best of the others."""

BOUND_ALL = 2.0
"""The same of all plates laid down alike. Right captures have 0.1 to 1.1."""

BETTER = 1.2
"""All plates laid down alike fit this many times as well as plates corrected one by one."""

TIMES_SD = 0.5
"""Standard deviation of that ratio between two ways that fit alike."""

BOUND_MM, PLACE_MM = 50.0, 15.0
"""Largest distance from its place without a warning, and error of scaled bodies' centres of mass."""

NOISE_S = 0.1
"""Correlation time of the difference between motion and plates."""

ALONE, BESIDE = 0.7, 0.25
"""A plate is judged while it carries the first share of the load; its axes, if it never does, the second share."""

MATCHES = 0.25
"""Frames count in which the plates' vertical force is that of the motion to this share, up to one gain."""

LEAST_S = 0.2
"""Least duration of such frames."""

UNLOADED = "nothing stands on this plate alone for long enough"


def axes_findings(evidence: Evidence) -> tuple[tuple[Finding, ...], tuple[PlateReadings, ...]]:
    """One finding for each plate, and the plates with wrong axes corrected.

    The plate that gains most is corrected first; the others are then judged beside the corrected one. Where all plates
    laid down alike fit better than the corrected ones, these are the plates as they fit.
    """
    found: dict[int, Finding] = {}
    as_read = evidence
    while True:
        others = [p for p in range(len(evidence.plates)) if p not in found]
        judged = {p: _axes(evidence, p) for p in others}
        outside = [p for p in others if judged[p][0].verdict == "outside"]
        if not outside:
            found |= {p: finding for p, (finding, _) in judged.items()}
            alike, plates = _all_axes(as_read)
            corrected, _ = better_fit(as_read, [evidence.plates])
            if alike is None or (alike.value or 0.0) < BETTER * corrected:
                alike, plates = None, evidence.plates
            return (*(found[p] for p in sorted(found)), *([] if alike is None else [alike])), plates
        worst = max(outside, key=lambda p: judged[p][0].value or 0.0)
        found[worst], laid_down = judged[worst]
        evidence = evidence.with_plate(worst, laid_down)


def place_findings(evidence: Evidence) -> tuple[Finding, ...]:
    """Distance d of each plate from its place, from the missing moment d × f; of all together, where that is too far.

    Where two feet share the load all along, as in a squat, no plate is judged alone.
    """
    findings = []
    gain = _gain(evidence)
    for p, plate in enumerate(evidence.plates):
        name, frames = f"place of plate '{plate.name}'", _bearing(evidence, p, ALONE)
        if frames is None:
            findings.append(not_judged(name, "mm", BOUND_MM, UNLOADED))
            continue
        missing = (gain * evidence.asked - evidence.total)[frames]
        findings.append(_place(name, evidence.given[frames, p], missing, evidence.rate_hz))
    together = None if any(one.verdict == "outside" for one in findings) else _place_of_all(evidence)
    return tuple(findings) if together is None else (*findings, together)


def _place_of_all(evidence: Evidence) -> Finding | None:
    """A finding on the place of all plates, if it is too far off."""
    frames = carried(evidence)
    if len(evidence.plates) < 2 or frames.sum() < LEAST_S * evidence.rate_hz:
        return None
    total = evidence.total[frames]
    missing = _gain(evidence) * evidence.asked[frames] - total
    found = _place("place of all plates", total, missing, evidence.rate_hz)
    return found if found.verdict == "outside" else None


def laid(plate: PlateReadings, quarters: int, mirrored: bool) -> PlateReadings:
    """A plate's readings as if it were mirrored across its own x axis, then turned about the vertical.

    Args:
        plate: The plate.
        quarters: Number of quarter turns.
        mirrored: False to turn it only.
    """
    turn = _matrix(plate, quarters, mirrored)
    # A moment is an axial vector: mirrored, it changes its sign besides.
    axial = turn * (-1.0 if mirrored else 1.0)
    pressed = plate.origin_m + (plate.centre_of_pressure_m - plate.origin_m) @ turn.T
    return replace(
        plate,
        force_n=plate.force_n @ turn.T,
        moment_nm=plate.moment_nm @ axial.T,
        centre_of_pressure_m=pressed,
    )


def turned_with_room(plate: PlateReadings, quarters: int) -> PlateReadings:
    """A plate's readings and place as if the laboratory were turned about the vertical through its origin.

    Args:
        plate: The plate.
        quarters: Number of quarter turns.
    """
    cos, sin = ((1, 0), (0, 1), (-1, 0), (0, -1))[quarters % 4]
    turn = np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]]).T
    return replace(
        plate,
        origin_m=plate.origin_m @ turn,
        force_n=plate.force_n @ turn,
        moment_nm=plate.moment_nm @ turn,
        centre_of_pressure_m=plate.centre_of_pressure_m @ turn,
        corners_m=None if plate.corners_m is None else plate.corners_m @ turn,
    )


def _matrix(plate: PlateReadings, quarters: int, mirrored: bool) -> Array:
    """(3, 3) of world axes: the plate's own horizontal axis is that of its first edge, or the world's."""
    edge = np.array([1.0, 0.0, 0.0])
    if plate.corners_m is not None:
        edge = plate.corners_m[1] - plate.corners_m[0]
        edge = edge * [1.0, 1.0, 0.0] / np.hypot(edge[0], edge[1])
    axes = np.array([edge, [-edge[1], edge[0], 0.0], [0.0, 0.0, 1.0]]).T
    cos, sin = ((1, 0), (0, 1), (-1, 0), (0, -1))[quarters % 4]
    turn = np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])
    return np.asarray(axes @ turn @ np.diag([1.0, -1.0 if mirrored else 1.0, 1.0]) @ axes.T)


def _ways() -> Iterator[tuple[int, bool, str]]:
    """The other ways to lay a plate down: number of quarter turns, mirrored or not, and text."""
    for mirrored in (False, True):
        for quarters in range(4):
            words = [f"turned by {90 * quarters}°"] if quarters else []
            if mirrored:
                words = ["mirrored", *words]
            if words:
                yield quarters, mirrored, " and ".join(words)


def carried(evidence: Evidence) -> BoolArray:
    """(T,) frames in which plates carry the force that the motion requires, up to one gain."""
    asked, total = evidence.asked[:, 2], evidence.total[:, 2]
    bears = evidence.known & (asked > 0.3 * evidence.weight_n) & (total > 0.3 * asked)
    if not bears.any():
        return bears
    share = np.where(bears, total / np.where(bears, asked, 1.0), np.nan)
    return bears & (np.abs(share / np.nanmedian(share) - 1.0) < MATCHES)


def _bearing(evidence: Evidence, p: int, *shares: float) -> BoolArray | None:
    """(T,) frames in which plate ``p`` carries the first of the shares (both by default) that lasts; None else."""
    share = evidence.given[:, p, 2] / np.maximum(evidence.total[:, 2], 1.0)
    for least in shares or (ALONE, BESIDE):
        frames = carried(evidence) & (share > least)
        if frames.sum() >= LEAST_S * evidence.rate_hz:
            return frames
    return None


def _gain(evidence: Evidence) -> float:
    """Force of the plates over that of the motion, so that a wrong mass is not blamed on a plate."""
    frames = carried(evidence)
    if not frames.any():
        return 1.0
    return float(evidence.total[frames, 2].sum() / evidence.asked[frames, 2].sum())


def _misfit(missing: Array, weight_n: float) -> float:
    """Root mean square of a missing wrench (n, 6) in units of its usual misfit, shear and moment alike."""
    shear, moment = missing[:, :2] / (SHEAR_SHARE * weight_n), missing[:, 3:] / (MOMENT_M * weight_n)
    return float(np.sqrt(np.mean(np.hstack([shear, moment]) ** 2)))


def _axes(evidence: Evidence, p: int) -> tuple[Finding, PlateReadings]:
    """The verdict on one plate's axes, and the plate as it fits."""
    plate, frames, gain = evidence.plates[p], _bearing(evidence, p), _gain(evidence)
    name = f"axes of plate '{plate.name}'"
    if frames is None:
        return not_judged(name, "times", BOUND, UNLOADED), plate
    ways = tuple(_ways())
    tried = [laid(plate, quarters, mirrored) for quarters, mirrored, _ in ways]
    changed = (evidence.given[:, p : p + 1] - evidence.gives(tried))[frames]
    missing, weight_n = (gain * evidence.asked - evidence.total)[frames], gain * evidence.weight_n
    misfit = _misfit(missing, weight_n)
    fits = [_misfit(missing + changed[:, k], weight_n) for k in range(len(tried))]
    best = int(np.argmin(fits))
    times = misfit / max(fits[best], 1e-9)
    verdict = judgement(times, TIMES_SD, BOUND)
    hint = "its misfit over the least one turned or mirrored"
    if verdict == "outside":
        hint = f"{ways[best][2]} it fits {times:.1f} times as well: check its corners and axes"
    return Finding(name, times, TIMES_SD, "times", BOUND, verdict, hint), tried[best]


def _all_axes(evidence: Evidence) -> tuple[Finding | None, tuple[PlateReadings, ...]]:
    """A finding on all plates laid down alike, as one wrong convention does, and the plates as they fit; None if right.

    Where two feet share the load all along, as in a squat, one plate corrected beside a wrong one fits no better. Axes
    of the markers' file that are turned against those of the plates turn the places of the plates as well; that has to
    fit better than a displacement of all plates.
    """
    if len(evidence.plates) < 2:
        return None, evidence.plates
    tried: list[tuple[str, tuple[PlateReadings, ...]]] = [
        (
            f"all plates {words} fit {{times:.1f}} times as well: check corners and axes",
            tuple(laid(plate, quarters, mirrored) for plate in evidence.plates),
        )
        for quarters, mirrored, words in _ways()
    ]
    alike = len(tried)
    tried += [
        (
            f"with all plates and their places turned by {90 * quarters}° about the laboratory's origin they fit "
            "{times:.1f} times as well: check the axes of markers and plates",
            tuple(turned_with_room(plate, quarters) for plate in evidence.plates),
        )
        for quarters in (1, 2, 3)
    ]
    times, best = better_fit(evidence, [plates for _, plates in tried])
    if best is None or not times > BOUND_ALL:
        return None, evidence.plates
    if best >= alike and times < BETTER * _displaced_fit(evidence):
        return None, evidence.plates
    hint, plates = tried[best]
    words = hint.format(times=times)
    return Finding("axes of all plates", times, TIMES_SD, "times", BOUND_ALL, "outside", words), plates


def _displaced_fit(evidence: Evidence) -> float:
    """Misfit of the plates over that of the best displacement of all of them together."""
    frames, gain = carried(evidence), _gain(evidence)
    missing = (gain * evidence.asked - evidence.total)[frames]
    force, left, weight_n = evidence.total[frames, 2], missing.copy(), gain * evidence.weight_n
    left[:, 3:5] -= np.outer(force, force @ missing[:, 3:5]) / (force @ force)
    return _misfit(missing, weight_n) / max(_misfit(left, weight_n), 1e-9)


def better_fit(evidence: Evidence, tried: Sequence[tuple[PlateReadings, ...]]) -> tuple[float, int | None]:
    """Misfit of the plates over the least one of other readings of all of them, and which; None: not to be judged.

    Args:
        evidence: Motion and plates.
        tried: Other readings of all plates.
    """
    frames, gain = carried(evidence), _gain(evidence)
    if frames.sum() < LEAST_S * evidence.rate_hz:
        return 0.0, None
    asked, weight_n = gain * evidence.asked[frames], gain * evidence.weight_n
    misfit = _misfit(asked - evidence.total[frames], weight_n)
    fits = [_misfit(asked - evidence.gives(one).sum(axis=1)[frames], weight_n) for one in tried]
    if not np.isfinite(fits).any():
        return 0.0, None
    best = int(np.nanargmin(fits))
    return misfit / max(fits[best], 1e-9), best


def _place(name: str, given: Array, missing: Array, rate_hz: float) -> Finding:
    """Distance d of a plate from its place, from its wrench (n, 6) and the missing one, whose moment is d × f."""
    # The part common to all frames counts: the mean moment over the mean force.
    force, moment = given[:, 2].mean(), missing[:, 3:5]
    along, across = -moment[:, 1].mean() / force, moment[:, 0].mean() / force
    off_mm = 1e3 * float(np.hypot(along, across))
    samples = max(len(moment) / (NOISE_S * rate_hz), 1.0)
    sd_mm = 1e3 * float(moment.std(axis=0).max() / force / np.sqrt(samples))
    sd_mm = float(np.hypot(sd_mm, PLACE_MM))
    hint = f"the motion places it {1e3 * along:+.0f} mm along x, {1e3 * across:+.0f} mm along y from the file's place"
    return judged(name, off_mm, sd_mm, "mm", BOUND_MM, hint)
