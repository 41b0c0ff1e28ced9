"""Search for parts of the body that carry load besides the feet, before a trial is filtered.

While plates read every foot, the wrench that the motion of the markers requires and the plates lack acts elsewhere: its
line of action leads through the loaded part (:mod:`mbkf.sensors.supports.momentum`). While a foot stands beside the
plates, and without plates, parts that lie low and still on the floor carry load.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array, BoolArray
from mbkf.model.body import Body
from mbkf.numerics.printed import percent
from mbkf.numerics.runs import stretches
from mbkf.numerics.windows import bridged, dilated
from mbkf.sensors.contact.soles import sole_points
from mbkf.sensors.supports.bearings import BearingParts
from mbkf.sensors.supports.momentum import WholeBody
from mbkf.sensors.supports.seat import STILL_M_S, sits

WINDOW_S, EDGE_WINDOW_S = 0.25, 0.1
"""Durations over which a missing wrench is averaged: to detect it, and to time its begin and end."""

LEAST_SHARE, LASTING_SHARE, EDGE_SHARE = 0.08, 0.04, 0.025
"""Shares of body weight: a force is missing above the first, lasts while it is above the second over the wide window,
and begins and ends where it is above the third over the narrow one."""

LASTING_S = 0.25
"""Least duration: the effect of wrong masses changes faster in a step."""

EDGE_S = 0.15
"""Largest distance of begin and end from the wide window's first and last frame."""

BODY_LEVER_M = 0.02
"""Error of scaled bodies' moment about the centre of mass, in body weights times m."""

FITS = 2.0
"""Largest distance, in standard deviations, of a missing wrench's line of action from its part's middle."""

SOLE_LEVER_M = 0.1
"""Largest distance of a centre of pressure from the middle of its sole."""

PAIR_PENALTY = 0.5
"""Least advantage of two parts over one, squared deviations: their share is a free parameter."""

ON_FLOOR_M, RESTS_M_S, RESTS_S = 0.05, 0.4, 0.1
"""Largest height over the soles' floor, largest speed and least duration of a part that lies on the floor."""

ALWAYS_SHARE = 0.9
"""A force missing in more than this share of the frames is an error of mass or plates, not a contact, unless more is
missing than a mass is wrong by, and feet bear the rest: then a person sits throughout."""

WRONG_MASS = "check the mass, the plates' scale and the axes"
RIGHT_MASS = "the mass is not the cause; check clocks and axes, or the motion is faster than skin follows"
"""Remedies where the mean of the missing force is vertical, and where it is not."""

MASS_SHARE, SEATED_SHARE = 0.4, 0.02
"""No mass is wrong by the first share; feet of a seated person bear at least the second."""

FREE_S, MASS_ERROR = 0.5, 0.06
"""A mass is corrected, for this search alone and by no more than this share, where frames without a missing force last
so long: else the error of a mass lasts on as a seat that was left."""


class FeetLoads(Protocol):
    """Loads of the feet by the plates (:class:`mbkf.sensors.contact.offline.FootLoads`)."""

    @property
    def wrench(self) -> Array:
        """(T, 2, 6) force N and moment N m about the world's origin on right and left foot."""

    @property
    def valid(self) -> BoolArray:
        """(T,) frames in which every loaded foot stands on a recorded plate."""

    @property
    def floor_m(self) -> float:
        """Height of the floor; NaN where it is not known."""


@dataclass(frozen=True)
class OtherContacts:
    """Parts that carry load besides the feet.

    Attributes:
        flags: (T, B) loaded parts.
        remarks: Remarks on missing wrenches that no contact explains.
        lighter: Share by which the body is lighter than stated; NaN where frames without a missing force are too few.
    """

    flags: BoolArray
    remarks: tuple[str, ...] = ()
    lighter: float = float("nan")


def other_contacts(
    model: Body,
    q: Array,
    v: Array,
    rate_hz: float,
    loads: FeetLoads,
    read: BoolArray,
    doubted: BoolArray | None = None,
    unobservable: BoolArray | None = None,
) -> OtherContacts:
    """Parts that carry load in a trial.

    Args:
        model: The body.
        q: (T, nq) configurations from markers alone, NaN where untracked.
        v: (T, nv) velocities.
        rate_hz: Frame rate.
        loads: Loads of the feet by the plates.
        read: (T,) frames in which all plates were recorded; all False without plates.
        doubted: (T,) frames in which something else than a contact is known to explain a missing wrench; they are not
            searched. None for none of them.
        unobservable: (nv,) dofs that move no marker; None: markers show every dof.
    """
    bearings = BearingParts(model, unobservable)
    moving = bearings.course(q, v)
    points, speeds = moving.points_m, moving.speeds_m_s
    judged = read & loads.valid & ~np.isnan(q).any(axis=1)
    body, soles = WholeBody.of(model, q, v), sole_points(model, q)
    reached = np.concatenate([points, soles.mean(axis=2)], axis=1)
    searched = judged if doubted is None else judged & ~doubted
    found = _missing(bearings, reached, speeds, body, rate_hz, loads, searched)
    flags = found.flags
    lying = _lying(bearings, points, speeds, rate_hz, loads.floor_m)
    # Beside a part that carries load on the floor, others that lie there do so as well.
    kneels = (flags & lying).any(axis=1)
    flags |= lying & (kneels | ~judged)[:, None]
    if not read.any() and bearings.seat >= 0:
        k = bearings.seat
        seated = sits(body, soles, points[:, k], speeds[:, k], rate_hz, loads.floor_m)
        flags[:, k] |= seated & ~lying.any(axis=1)
    return replace(found, flags=flags)


def _missing(
    bearings: BearingParts,
    points: Array,
    speeds: Array,
    body: WholeBody,
    rate_hz: float,
    loads: FeetLoads,
    judged: BoolArray,
) -> OtherContacts:
    """Parts through which a missing wrench leads, and remarks on wrenches that miss every part.

    Args:
        bearings: The parts.
        points: (T, B + 2, 3) their middles, and those of the soles of right and left foot.
        speeds: (T, B) speeds of their middles.
        body: The body's momentum.
        rate_hz: Frame rate.
        loads: Loads of the feet by the plates.
        judged: (T,) frames in which plates read all loads of the feet.
    """
    flags = np.zeros((len(points), len(bearings)), dtype=bool)
    given = np.where(judged[:, None], loads.wrench.sum(axis=1), 0.0)
    weight_n = float(np.linalg.norm(body.weight))
    slow, fast = (body.missing_wrench(given, rate_hz, s) for s in (WINDOW_S, EDGE_WINDOW_S))
    # Windows have to lie within judged frames.
    clear = judged & ~dilated(~judged, round(0.5 * WINDOW_S * rate_hz))
    lacks = clear & (np.linalg.norm(slow[:, :3], axis=1) > LEAST_SHARE * weight_n)
    if lacks.sum() > ALWAYS_SHARE * max(int(clear.sum()), 1):
        share = float(np.mean(slow[lacks, 2])) / weight_n
        whole = float(np.mean(np.linalg.norm(slow[lacks, :3], axis=1))) / weight_n
        if abs(share) < MASS_SHARE or np.median(given[lacks, 2]) < SEATED_SHARE * weight_n:
            remark = (
                f"motion and plates differ by {percent(whole)} of body weight on average, throughout, vertically by "
                f"{percent(share, signed=True)}: {WRONG_MASS if abs(share) > LASTING_SHARE else RIGHT_MASS}"
            )
            return OtherContacts(flags, (remark,))
    lighter = _lighter(slow[:, 2], given[:, 2], clear & ~lacks, rate_hz)
    for missing in (slow, fast):
        missing[:, :3] -= np.nan_to_num(lighter) * (missing[:, :3] + given[:, :3])
    size = np.where(clear, np.linalg.norm(slow[:, :3], axis=1), 0.0)
    lacks = size > LEAST_SHARE * weight_n
    remarks = []
    for run in _lasting(size > LASTING_SHARE * weight_n, rate_hz):
        force = slow[run, :3].mean(axis=0)
        if lacks[run].sum() < LASTING_S * rate_hz or np.linalg.norm(force) < LASTING_SHARE * weight_n:
            continue
        # A hand may hold something that moves; a pelvis or a knee rests on things that do not.
        rests = bearings.placed & (bearings.grips | (np.median(speeds[run], axis=0) < STILL_M_S))
        parts = _fitting(bearings, rests, points[run] - body.centre_m[run, None], slow[run], weight_n)
        frames = _edges(run, fast[:, :3], force, weight_n, rate_hz, judged)
        if parts is not None and parts[0] >= len(bearings):
            continue
        if parts is None:
            much, since = float(np.linalg.norm(force)), run[0] / rate_hz
            remarks.append(
                f"from {since:.2f} s for {len(run) / rate_hz:.2f} s the motion requires {much:.0f} N that neither the "
                "plates nor a contact of another part explain: check plates and axes"
            )
        else:
            flags[frames[:, None], list(parts)] = True
    return OtherContacts(_bridged(flags, judged, rate_hz), tuple(remarks), lighter)


def _lighter(missing_n: Array, given_n: Array, free: BoolArray, rate_hz: float) -> float:
    """Share by which the body is lighter than stated, by frames in which feet bear it alone; NaN where these are few.

    Args:
        missing_n: (T,) vertical force that the motion requires besides the given one.
        given_n: (T,) vertical force of the feet.
        free: (T,) those frames.
        rate_hz: Frame rate.
    """
    required = missing_n + given_n
    free = free & (required > 0.5 * np.median(required[free])) if free.any() else free
    if free.sum() < FREE_S * rate_hz:
        return float("nan")
    return float(np.clip(np.median(missing_n[free] / required[free]), -MASS_ERROR, MASS_ERROR))


def _bridged(flags: BoolArray, judged: BoolArray, rate_hz: float) -> BoolArray:
    """Flags (T, B) continued through short stretches of frames that are not ``judged`` (T,)."""
    found = flags.copy()
    for run in stretches(~judged):
        sides = [t for t in (int(run[0]) - 1, int(run[-1]) + 1) if 0 <= t < len(flags)]
        if sides and len(run) < LASTING_S * rate_hz:
            found[run] |= flags[sides].all(axis=0)
    return found


def _lasting(lacks: BoolArray, rate_hz: float) -> list[Array]:
    """Stretches of a mask (T,) of the least duration, across shorter gaps."""
    gap = max(1, round(0.5 * LASTING_S * rate_hz))
    return [run for run in stretches(bridged(lacks, gap)) if len(run) >= LASTING_S * rate_hz]


def _edges(
    run: Array, fast: Array, force: Array, weight_n: float, rate_hz: float, judged: BoolArray
) -> NDArray[np.intp]:
    """Frames of a stretch, from begin to end of the missing force along its mean direction.

    Args:
        run: Frames of the stretch.
        fast: (T, 3) missing force over a short window.
        force: (3,) its mean.
        weight_n: The body's weight.
        rate_hz: Frame rate.
        judged: (T,) frames in which plates read all loads of the feet.
    """
    along = fast @ force / np.linalg.norm(force)
    acts = judged & (along > EDGE_SHARE * weight_n)
    reach = round(EDGE_S * rate_hz)
    first, last = int(run[0]), int(run[-1])
    low, high = max(first - reach, 0), min(last + reach, len(fast) - 1)
    begins = np.flatnonzero(acts[low : first + reach + 1])
    ends = (
        np.flatnonzero(acts[last - reach : high + 1]) if last >= reach else np.flatnonzero(acts[: high + 1])
    )
    start = low + int(begins[0]) if len(begins) else first
    stop = max(last - reach, 0) + int(ends[-1]) if len(ends) else last
    return np.arange(start, max(stop, start) + 1)


def _fitting(
    bearings: BearingParts, rests: BoolArray, arms: Array, missing: Array, weight_n: float
) -> tuple[int, ...] | None:
    """Parts through which a stretch's missing wrench leads best; None if it misses every part.

    B is the right foot, B + 1 the left one, which may stand where no plate reads.

    Args:
        bearings: The parts.
        rests: (B,) those that are slow enough to carry load, and hands.
        arms: (n, B + 2, 3) from the centre of mass to their middles and those of the soles.
        missing: (n, 6) wrench about the centre of mass.
        weight_n: The body's weight.
    """
    best, least = None, FITS**2
    levers = np.append(bearings.levers_m, [SOLE_LEVER_M, SOLE_LEVER_M])
    for parts in _groups(bearings, rests, missing[:, :3].mean(axis=0)):
        lever = float(levers[list(parts)].mean())
        off = _off(arms[:, list(parts)], missing, lever, weight_n) + PAIR_PENALTY * (len(parts) - 1)
        if off < least:
            best, least = parts, off
    return best


def _groups(bearings: BearingParts, rests: BoolArray, force: Array) -> Iterator[tuple[int, ...]]:
    """Parts, feet, and right and left ones together, that could carry a force (3,): hands alone if it does not push up.

    Args:
        bearings: The parts.
        rests: (B,) those that are slow enough to carry load, and hands.
        force: (3,) the force.
    """
    pushes = float(force[2]) > 0.5 * float(np.linalg.norm(force))
    usable = [k for k in map(int, np.flatnonzero(rests)) if pushes or bearings.grips[k]]
    yield from ((k,) for k in usable)
    if pushes:
        right, left = len(bearings), len(bearings) + 1
        yield from ((right,), (left,), (right, left))
    yield from (pair for pair in bearings.pairs if pair[0] in usable and pair[1] in usable)


def _off(arms: Array, missing: Array, lever_m: float, weight_n: float) -> float:
    """Mean squared deviations by which a wrench misses one part, or two with the share that fits best.

    Args:
        arms: (n, 1 or 2, 3) from the centre of mass to the parts' middles.
        missing: (n, 6) wrench about the centre of mass.
        lever_m: Largest distance of a part's centre of pressure from its middle.
        weight_n: The body's weight.
    """
    force, moment = missing[:, :3], missing[:, 3:]
    sd = np.hypot(lever_m * np.linalg.norm(force, axis=1), BODY_LEVER_M * weight_n)[:, None]
    off = (moment - np.cross(arms[:, 0], force)) / sd
    if arms.shape[1] > 1:
        turn = np.cross(arms[:, 1] - arms[:, 0], force) / sd
        share = float(np.clip((off * turn).sum() / max((turn * turn).sum(), 1e-9), 0.0, 1.0))
        off = off - share * turn
    return float((off**2).sum(axis=1).mean())


def _lying(bearings: BearingParts, points: Array, speeds: Array, rate_hz: float, floor_m: float) -> BoolArray:
    """(T, B) parts with middles (T, B, 3) and speeds (T, B) that lie on the floor."""
    low = (points[:, :, 2] - bearings.radii_m - floor_m < ON_FLOOR_M) & (speeds < RESTS_M_S) & bearings.placed
    found = np.zeros_like(low)
    for k in range(len(bearings)):
        for run in stretches(low[:, k]):
            found[run, k] = len(run) >= RESTS_S * rate_hz
    return found
