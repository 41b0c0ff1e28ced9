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
from mbkf.numerics.rotations import skew
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
            corrected, _ = better_fit(as_read, [evidence.total])
            if alike is None or (alike.value or 0.0) < BETTER * corrected:
                alike, plates = None, evidence.plates
            return (*(found[p] for p in sorted(found)), *([] if alike is None else [alike])), plates
        worst = max(outside, key=lambda p: judged[p][0].value or 0.0)
        found[worst], (quarters, mirrored, _) = judged[worst]
        plate = evidence.plates[worst]
        wrench = evidence.raw[:, worst] @ _laid_map(plate, quarters, mirrored).T
        evidence = evidence.with_plate(worst, laid(plate, quarters, mirrored), wrench)


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
    frames = evidence.carried
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
    turn, axial = _turns(plate, quarters, mirrored)
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
    turn = _quarters(quarters).T
    return replace(
        plate,
        origin_m=plate.origin_m @ turn,
        force_n=plate.force_n @ turn,
        moment_nm=plate.moment_nm @ turn,
        centre_of_pressure_m=plate.centre_of_pressure_m @ turn,
        corners_m=None if plate.corners_m is None else plate.corners_m @ turn,
    )


def _laid_map(plate: PlateReadings, quarters: int, mirrored: bool) -> Array:
    """(6, 6) from a plate's wrench about the world's origin to that of :func:`laid`."""
    turn, axial = _turns(plate, quarters, mirrored)
    arm, by = skew(plate.origin_m), np.zeros((6, 6))
    by[:3, :3], by[3:, 3:] = turn, axial
    by[3:, :3] = arm @ turn - axial @ arm
    return by


def _room_map(quarters: int) -> Array:
    """(6, 6) from a wrench about the world's origin to that of :func:`turned_with_room`."""
    return np.asarray(np.kron(np.eye(2), _quarters(quarters)), dtype=np.float64)


def _quarters(quarters: int) -> Array:
    """(3, 3) turn about the vertical by so many quarters."""
    cos, sin = ((1, 0), (0, 1), (-1, 0), (0, -1))[quarters % 4]
    return np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])


def _turns(plate: PlateReadings, quarters: int, mirrored: bool) -> tuple[Array, Array]:
    """(3, 3) of forces and of moments; a moment is an axial vector: mirrored, it changes its sign besides."""
    turn = _matrix(plate, quarters, mirrored)
    return turn, turn * (-1.0 if mirrored else 1.0)


def _matrix(plate: PlateReadings, quarters: int, mirrored: bool) -> Array:
    """(3, 3) of world axes: the plate's own horizontal axis is that of its first edge, or the world's."""
    edge = np.array([1.0, 0.0, 0.0])
    if plate.corners_m is not None:
        edge = plate.corners_m[1] - plate.corners_m[0]
        edge = edge * [1.0, 1.0, 0.0] / np.hypot(edge[0], edge[1])
    axes = np.array([edge, [-edge[1], edge[0], 0.0], [0.0, 0.0, 1.0]]).T
    return np.asarray(axes @ _quarters(quarters) @ np.diag([1.0, -1.0 if mirrored else 1.0, 1.0]) @ axes.T)


Way = tuple[int, bool, str]
"""A way to lay a plate down: number of quarter turns, mirrored or not, and text."""


def _ways() -> Iterator[Way]:
    """The other ways to lay a plate down."""
    for mirrored in (False, True):
        for quarters in range(4):
            words = [f"turned by {90 * quarters}°"] if quarters else []
            if mirrored:
                words = ["mirrored", *words]
            if words:
                yield quarters, mirrored, " and ".join(words)


def _bearing(evidence: Evidence, p: int, *shares: float) -> BoolArray | None:
    """(T,) frames in which plate ``p`` carries the first of the shares (both by default) that lasts; None else."""
    share = evidence.given[:, p, 2] / np.maximum(evidence.total[:, 2], 1.0)
    for least in shares or (ALONE, BESIDE):
        frames = evidence.carried & (share > least)
        if frames.sum() >= LEAST_S * evidence.rate_hz:
            return frames
    return None


def _gain(evidence: Evidence) -> float:
    """Force of the plates over that of the motion, so that a wrong mass is not blamed on a plate."""
    frames = evidence.carried
    if not frames.any():
        return 1.0
    return float(evidence.total[frames, 2].sum() / evidence.asked[frames, 2].sum())


def _misfit(missing: Array, weight_n: float) -> float:
    """Root mean square of a missing wrench (n, 6) in units of its usual misfit, shear and moment alike."""
    shear, moment = missing[:, :2] / (SHEAR_SHARE * weight_n), missing[:, 3:] / (MOMENT_M * weight_n)
    return float(np.sqrt(np.mean(np.hstack([shear, moment]) ** 2)))


def _axes(evidence: Evidence, p: int) -> tuple[Finding, Way]:
    """The verdict on one plate's axes, and the other way to lay it down that fits best."""
    plate, frames, gain, ways = evidence.plates[p], _bearing(evidence, p), _gain(evidence), tuple(_ways())
    name = f"axes of plate '{plate.name}'"
    if frames is None:
        return not_judged(name, "times", BOUND, UNLOADED), ways[0]
    maps = np.array([_laid_map(plate, quarters, mirrored) for quarters, mirrored, _ in ways])
    tried = evidence.averaged(np.einsum("kij,tj->tki", maps, evidence.raw[:, p]))
    changed = (evidence.given[:, p : p + 1] - tried)[frames]
    missing, weight_n = (gain * evidence.asked - evidence.total)[frames], gain * evidence.weight_n
    misfit = _misfit(missing, weight_n)
    fits = [_misfit(missing + changed[:, k], weight_n) for k in range(len(ways))]
    best = int(np.argmin(fits))
    times = misfit / max(fits[best], 1e-9)
    verdict = judgement(times, TIMES_SD, BOUND)
    hint = "its misfit over the least one turned or mirrored"
    if verdict == "outside":
        hint = f"{ways[best][2]} it fits {times:.1f} times as well: check its corners and axes"
    return Finding(name, times, TIMES_SD, "times", BOUND, verdict, hint), ways[best]


def _all_axes(evidence: Evidence) -> tuple[Finding | None, tuple[PlateReadings, ...]]:
    """A finding on all plates laid down alike, as one wrong convention does, and the plates as they fit; None if right.

    Where two feet share the load all along, as in a squat, one plate corrected beside a wrong one fits no better. Axes
    of the markers' file that are turned against those of the plates turn the places of the plates as well; that has to
    fit better than a displacement of all plates.
    """
    plates, ways, turns = evidence.plates, tuple(_ways()), (1, 2, 3)
    if len(plates) < 2:
        return None, plates
    alike = [[_laid_map(plate, quarters, mirrored) for plate in plates] for quarters, mirrored, _ in ways]
    with_room = [[_room_map(quarters)] * len(plates) for quarters in turns]
    times, best = better_fit(evidence, _sums(evidence, np.array(alike + with_room)))
    if best is None or not times > BOUND_ALL:
        return None, plates
    if best < len(ways):
        quarters, mirrored, words = ways[best]
        hint = f"all plates {words} fit {times:.1f} times as well: check corners and axes"
        plates = tuple(laid(plate, quarters, mirrored) for plate in plates)
    elif times < BETTER * _displaced_fit(evidence):
        return None, plates
    else:
        quarters = turns[best - len(ways)]
        hint = (
            f"with all plates and their places turned by {90 * quarters}° about the laboratory's origin they fit "
            f"{times:.1f} times as well: check the axes of markers and plates"
        )
        plates = tuple(turned_with_room(plate, quarters) for plate in plates)
    return Finding("axes of all plates", times, TIMES_SD, "times", BOUND_ALL, "outside", hint), plates


def _sums(evidence: Evidence, maps: Array) -> list[Array]:
    """(T, 6) wrench of all plates together for each of several maps (K, P, 6, 6) of their readings."""
    summed = evidence.averaged(np.einsum("kpij,tpj->tki", maps, evidence.raw))
    return list(summed.transpose(1, 0, 2))


def _displaced_fit(evidence: Evidence) -> float:
    """Misfit of the plates over that of the best displacement of all of them together."""
    frames, gain = evidence.carried, _gain(evidence)
    missing = (gain * evidence.asked - evidence.total)[frames]
    force, left, weight_n = evidence.total[frames, 2], missing.copy(), gain * evidence.weight_n
    left[:, 3:5] -= np.outer(force, force @ missing[:, 3:5]) / (force @ force)
    return _misfit(missing, weight_n) / max(_misfit(left, weight_n), 1e-9)


def better_fit(evidence: Evidence, tried: Sequence[Array]) -> tuple[float, int | None]:
    """Misfit of the plates over the least one of other readings of all of them, and which; None: not to be judged.

    Args:
        evidence: Motion and plates.
        tried: (T, 6) wrench of all plates together by each of the other readings.
    """
    frames, gain = evidence.carried, _gain(evidence)
    if frames.sum() < LEAST_S * evidence.rate_hz:
        return 0.0, None
    asked, weight_n = gain * evidence.asked[frames], gain * evidence.weight_n
    misfit = _misfit(asked - evidence.total[frames], weight_n)
    fits = [_misfit(asked - one[frames], weight_n) for one in tried]
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
