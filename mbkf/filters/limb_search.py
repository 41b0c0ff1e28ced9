"""Search for a better pose of a limb in doubt: several starts and several orders of names, compared by fit and ranges.

The rest of the body stays. A limb that has been in doubt for some looks is fitted in the latest frame and in an early
one of them. A limb whose markers leave their prediction all at once either is elsewhere than the filter had it, or its
markers have other names from this frame on; then the pose moves on as predicted, and a jump costs.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array
from mbkf.filters.limb_mend import LimbMend
from mbkf.model.body import Body
from mbkf.model.limbs import Limb
from mbkf.sensors.limb_fit import LEAST_SEEN, STRAY_M, LimbFits, LimbPose
from mbkf.sensors.limb_starts import Order, order_starts, pose_starts

LIKELIER, LESS = 0.4, 40.0
"""A new pose has at most this share of the cost of the pose in doubt, and so much less a frame."""

NAMES_LIKELIER = 0.4
"""Other names have at most this share of the cost of the best pose under the names as they are."""

FITS_M, BEYOND_RAD = 0.03, np.radians(12.0)
"""A new pose fits its markers better than this (RMS), and no joint lies further beyond its range."""

WORSE, CLOSE_M = 1.5, 0.005
"""... nor so many times worse than the pose in doubt, unless it fits as well as this: ranges alone move no limb."""

GOOD_M = 0.015
"""A pose that fits better than this, within its ranges, needs no other start, and no other names."""

JUMP_SD_RAD = 0.5
"""Spread of a joint's rotation from its prediction where a limb is suddenly in doubt."""

DRAWN = 0.06
"""A trunk that the limb in doubt has drawn further than this, m or rad, is set right with it."""

SAME_RAD = np.radians(20.0)
"""Poses of a limb whose joints differ by less are the same."""


class Look(NamedTuple):
    """A frame that was looked at.

    Attributes:
        number: Its number.
        q: (nq,) estimated or predicted configuration.
        markers_m: (M, 3) its markers under the capture's own names.
    """

    number: int
    q: Array
    markers_m: Array


class Hypothesis(NamedTuple):
    """One limb or both sides' in a pose under names.

    Attributes:
        limbs: The limbs.
        order: (M,) names; None: the capture's own.
        poses: (nq,) configuration in every frame that was looked at.
        cost: Sum over limbs and frames.
        worst_m: Worst fit of a limb in a frame, m.
        beyond_rad: Largest distance of a joint from its range, rad.
    """

    limbs: tuple[Limb, ...]
    order: Order | None
    poses: tuple[Array, ...]
    cost: float
    worst_m: float
    beyond_rad: float

    @property
    def possible(self) -> bool:
        """True where it fits and lies within its ranges."""
        return self.worst_m <= FITS_M and self.beyond_rad <= BEYOND_RAD

    @property
    def good(self) -> bool:
        """True where it leaves nothing to explain."""
        return self.worst_m <= GOOD_M and self.beyond_rad <= BEYOND_RAD


class LimbSearch:
    """Finds better poses of limbs."""

    def __init__(self, fits: LimbFits, dt_s: float) -> None:
        """Args: the limbs, and the time between frames."""
        self._fits, self._dt_s = fits, dt_s

    def found(
        self, limb: Limb, order: Order | None, looks: Sequence[Look], sudden: bool = False
    ) -> LimbMend | None:
        """The likeliest pose and names of a limb in doubt; None where those it has are about as likely.

        Args:
            limb: The limb.
            order: (M,) names under which the filter reads markers; None: the capture's own.
            looks: Frames in which it is compared, the latest first.
            sudden: The limb left its prediction in this frame.
        """
        now, asked = self._as_is((limb,), order, looks), looks
        if not sudden:
            looks = [one._replace(q=self._fits.trunk(one.q, named(one.markers_m, order))) for one in looks]
        best = min(self._by_pose(limb, order, looks, sudden), key=lambda one: one.cost)
        chosen = best if _better(best, now, len(looks)) else None
        explained = best.good and (not sudden or _same(self._model, looks[0].q, best.poses[0], limb.dofs))
        for other in () if explained else self._by_names(limb, order, looks, sudden):
            rest = self._as_is(other.limbs[1:], order, asked).cost
            other_now, under_names = now._replace(cost=now.cost + rest), best.cost + rest
            likely = other.cost <= NAMES_LIKELIER * under_names and _better(other, other_now, len(looks))
            alone = other._replace(cost=other.cost - rest)
            if likely and (chosen is None or chosen.order is order or alone.cost < chosen.cost):
                chosen = alone
        if chosen is None:
            return None
        if chosen.order is order and self._same_minimum(limb, order, asked[0], chosen.poses[0]):
            return None
        return self._mend(chosen, looks, asked[0].q)

    def carried(self, mend: LimbMend, order: Order | None, look: Look) -> LimbMend | None:
        """A mend carried to the frame before; None where markers do not show the limb there.

        Args:
            mend: The mend in a frame.
            order: (M,) names; None: the capture's own.
            look: The frame before, as estimated.
        """
        fits, q, seen = self._fits, look.q, named(look.markers_m, order)
        for k, limb in enumerate(fits.limbs):
            if not np.isin(limb.dofs, mend.dofs).any():
                continue
            if np.count_nonzero(~np.isnan(seen[fits.on_limb[k], 0])) < LEAST_SEEN:
                return None
            pose = fits.fit(limb, _with(q, mend.q, limb), seen)
            if pose.rms_m > FITS_M:
                return None
            q = pose.q
        return LimbMend(q, mend.v, mend.dofs, mend.order)

    def _same_minimum(self, limb: Limb, order: Order | None, here: Look, found: Array) -> bool:
        """True where ranges alone part a new pose from the present one: markers would lead it back."""
        back = self._fits.fit(limb, found, named(here.markers_m, order), ranged=False).q
        return any(_same(self._model, here.q, one, limb.dofs) for one in (found, back))

    @property
    def _model(self) -> Body:
        return self._fits.sensor.model

    def _by_pose(
        self, limb: Limb, order: Order | None, looks: Sequence[Look], sudden: bool
    ) -> Iterator[Hypothesis]:
        """The limb under the names as they are, from each start until one fits well."""
        here = looks[0]
        for start in pose_starts(self._fits, limb, here.q, named(here.markers_m, order)):
            one = self._fitted((limb,), order, looks, start, sudden)
            yield one
            if one.good:
                return

    def _by_names(
        self, limb: Limb, order: Order | None, looks: Sequence[Look], sudden: bool
    ) -> Iterator[Hypothesis]:
        """The limb, and the other side's where they exchange markers, under other names."""
        here, fits = looks[0], self._fits
        seen, every = named(here.markers_m, order), np.arange(len(here.markers_m))
        distance = np.linalg.norm(seen - fits.sensor.positions(here.q), axis=1)
        other = [one for one in fits.limbs if one.name == limb.other_side]
        before = every if order is None else order
        for changed in order_starts(fits, limb, seen, distance > STRAY_M):
            beside = ((changed != every) & ~fits.on_limb[fits.limbs.index(limb)]).any()
            of = (limb, *other) if beside else (limb,)
            yield self._fitted(of, before[changed], looks, None, sudden)

    def _as_is(self, of: tuple[Limb, ...], order: Order | None, looks: Sequence[Look]) -> Hypothesis:
        """Limbs as they are estimated."""
        every = [(limb, look) for limb in of for look in looks]
        found = [self._fits.judged(limb, look.q, named(look.markers_m, order)) for limb, look in every]
        worst = max((one.rms_m for one in found), default=0.0)
        return Hypothesis(of, order, (), sum(one.cost for one in found), worst, 0.0)

    def _fitted(
        self,
        of: tuple[Limb, ...],
        order: Order | None,
        looks: Sequence[Look],
        start: Array | None,
        sudden: bool,
    ) -> Hypothesis:
        """Limbs fitted in all looks, the latest first, from where each has the other.

        Args:
            of: The limbs.
            order: Names.
            looks: The frames.
            start: (nq,) start in the latest frame; None for where the limb is, if suddenly in doubt, or the best one.
            sudden: The limb left its prediction in this frame.
        """
        fits, found = self._fits, []
        poses: list[Array] = []
        for look in looks:
            seen, q = named(look.markers_m, order), look.q
            for limb in of:
                if poses:
                    pose = fits.fit(limb, _with(q, poses[-1], limb), seen)
                elif start is not None:
                    pose = fits.fit(limb, _with(q, start, limb), seen)
                else:
                    pose = fits.fit(limb, q, seen) if sudden else self._from_all_starts(limb, q, seen)
                q = pose.q
                found.append(pose)
            poses.append(q)
        cost = sum(one.cost for one in found)
        if sudden:
            dofs = np.concatenate([limb.dofs for limb in of])
            cost += float(((self._model.difference(looks[0].q, poses[0])[dofs] / JUMP_SD_RAD) ** 2).sum())
        worst, beyond = max(one.rms_m for one in found), max(one.beyond_rad for one in found)
        return Hypothesis(of, order, tuple(poses), cost, worst, beyond)

    def _from_all_starts(self, limb: Limb, q: Array, seen: Array) -> LimbPose:
        """The likeliest of a limb's poses from its starts; the first one that fits well."""
        best: LimbPose | None = None
        for start in pose_starts(self._fits, limb, q, seen):
            pose = self._fits.fit(limb, start, seen)
            best = pose if best is None or pose.cost < best.cost else best
            if best.rms_m <= GOOD_M and best.beyond_rad <= BEYOND_RAD:
                break
        assert best is not None
        return best

    def _mend(self, chosen: Hypothesis, looks: Sequence[Look], q: Array) -> LimbMend:
        """The mend of an estimate q (nq,), with the trunk where the limb had drawn it away."""
        dofs, trunk = np.concatenate([limb.dofs for limb in chosen.limbs]), self._fits.trunk_dofs
        if np.abs(self._model.difference(q, chosen.poses[0])[trunk]).max(initial=0.0) > DRAWN:
            dofs = np.union1d(trunk, dofs)
        v = None
        if len(looks) > 1:
            elapsed = (looks[0].number - looks[-1].number) * self._dt_s
            v = self._model.difference(chosen.poses[-1], chosen.poses[0])[dofs] / elapsed
        return LimbMend(chosen.poses[0], v, dofs, chosen.order)


def named(markers_m: Array, order: Order | None) -> Array:
    """(M, 3) markers under an order of names (M,); None: as they are."""
    return markers_m if order is None else markers_m[order]


def agrees(model: Body, q: Array, mend: LimbMend) -> bool:
    """True where a pose has the limb about as a mend has it.

    Args:
        model: The body.
        q: (nq,) the pose.
        mend: The mend.
    """
    return _same(model, q, mend.q, mend.dofs)


def _same(model: Body, q: Array, other: Array, dofs: NDArray[np.intp]) -> bool:
    return bool(np.abs(model.difference(q, other)[dofs]).max() < SAME_RAD)


def _better(one: Hypothesis, now: Hypothesis, frames: int) -> bool:
    """True where a pose is possible, far likelier than the present one, and fits the markers about as well."""
    if not one.possible or one.worst_m > max(WORSE * now.worst_m, CLOSE_M):
        return False
    return one.cost <= min(LIKELIER * now.cost, now.cost - LESS * frames)


def _with(q: Array, other: Array, limb: Limb) -> Array:
    """(nq,) the pose q with a limb of another pose."""
    found = q.copy()
    for joint in limb.joints:
        found[joint.q] = other[joint.q]
    return found
