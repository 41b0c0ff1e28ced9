"""Watches the limbs of a track and sets right those that fit badly or lie beyond their ranges.

A filter follows the nearest minimum: a thigh that a bad start, a gap or exchanged names turned over stays so, while its
markers pull it and its ranges push. A few times in a tenth of a second every limb is judged by its markers and ranges;
one that stays in doubt is searched for a better pose (:mod:`mbkf.filters.limb_search`), while the rest of the body goes
on. A limb whose markers leave their prediction from one frame to the next, all of a segment at once, is searched in the
same frame, unless it was hidden before.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array
from mbkf.filters.estimate import Posterior
from mbkf.filters.limb_mend import LimbMend
from mbkf.filters.limb_search import BEYOND_RAD, LimbSearch, Look, named
from mbkf.io.limb_doubts import DoubtKind, LimbDoubt
from mbkf.sensors.limb_fit import LEAST_SEEN, LimbEvidence, LimbFits
from mbkf.sensors.limb_starts import Order

LOOK_S = 0.02
"""Time between two looks at the limbs."""

LOOKS_IN_DOUBT = 3
"""A limb is searched when so many looks in a row found it in doubt; at a start of the filter, one."""

MISFIT_M, TIMES_OTHERS = 0.03, 2.0
"""A limb is in doubt where markers of one of its segments lie so far (RMS), and so many times further than others, or
where a joint lies further beyond its range than any new pose may."""

SURELY = 0.999
"""Margin for rounding: limbs within this share of both limits are not in doubt."""

JUMP_M = 0.05
"""A limb is searched in the same frame where a segment's used markers lie so far (RMS) from their prediction: fast
limbs are mispredicted by less."""

PATIENCE_S, MOST_PATIENCE_S = 0.1, 1.0
"""After a search without success a limb in doubt is searched again after this time, which doubles up to the second."""

STATED_S = 0.25
"""A doubt that no new pose ends is stated where it lasts longer than this, and a shorter one where the limb was far."""

FAR = 2.0
"""A limb is far where misfit and excess over a range reach so many of their limits together: the worst short doubt of
fifteen clean trials reaches 1.75, a limb that turned over while it was hidden 3 to 8."""


@dataclass
class _Doubt:
    """A limb's doubt while it lasts.

    Attributes:
        since: Frame of the first look that found it.
        looks: Looks in a row that found it.
        due: Frame from which the limb is searched again.
        patience_s: Time to the search after the next.
        worst: Evidence of the worst look.
    """

    since: int
    looks: int
    due: int
    patience_s: float
    worst: LimbDoubt


class LimbWatch:
    """Watches one track.

    Attributes:
        doubts: Doubts that have ended, times in s since the first frame.
        order: (M,) place in the capture of each marker that the filter reads; None: as the capture names them.
    """

    def __init__(self, fits: LimbFits, dt_s: float) -> None:
        """Args: the limbs, and the time between frames."""
        self.doubts: list[LimbDoubt] = []
        self.order: Order | None = None
        self._fits, self._dt_s, self._search = fits, dt_s, LimbSearch(fits, dt_s)
        self._every = max(1, round(LOOK_S / dt_s))
        self._looks: deque[Look] = deque(maxlen=LOOKS_IN_DOUBT)
        self._last: Look | None = None
        self._open: dict[int, _Doubt] = {}
        self._due: dict[int, int] = {}  # frames from which limbs are searched again when they jump
        self._patience = max(1, round(PATIENCE_S / dt_s))

    def look(self, number: int, estimate: Posterior, markers_m: Array) -> LimbMend | None:
        """A better pose of a limb, where one is in doubt and a far likelier pose is known.

        Args:
            number: The frame; frames come in order, and go back where a track is taken up again.
            estimate: Its estimate.
            markers_m: (M, 3) its markers as the capture names them.
        """
        last, self._last = self._last, Look(number, estimate.q, markers_m)
        step = None if estimate.started else estimate.record.step
        if step is not None and last is not None:
            squared = step.decisions.notes.squared_m2
            # The sum of squares is never less than the maximum's square, and costs a fifth of its time.
            if squared is not None and squared @ squared > JUMP_M**4 and squared.max() > JUMP_M**2:
                mend = self._sudden(squared, Look(number, step.prior.state.q, markers_m), last)
                if mend is not None:
                    return mend
        if number % self._every and not estimate.started:
            return None
        if estimate.started:
            self._looks.clear()
        self._looks.append(self._last)
        return self._lasting(number, estimate)

    def so_far(self, number: int) -> tuple[LimbDoubt, ...]:
        """Doubts that have ended, and those that last long enough to be stated before a frame."""
        lasting = (one for one in self._open.values() if self._long(one, number))
        return (*self.doubts, *(self._timed(one, number) for one in lasting))

    def finish(self, number: int) -> None:
        """Ends the doubts that are open after the last frame."""
        for k in list(self._open):
            self._close(k, number)

    def back_to(self, number: int) -> None:
        """The track is taken up again at a frame, where the limb that was set right last has its new pose."""
        self._looks.clear()
        self._due.clear()
        self._last, at_s = None, number * self._dt_s
        last = self.doubts[-1]
        self.doubts[-1] = replace(last, from_s=min(last.from_s, at_s), right_from_s=at_s)

    def carried(self, mend: LimbMend, number: int, q: Array, markers_m: Array) -> LimbMend | None:
        """A mend carried to the frame before (:meth:`mbkf.filters.limb_search.LimbSearch.carried`).

        Args:
            mend: The mend in a frame.
            number: The frame before.
            q: (nq,) its estimate.
            markers_m: (M, 3) its markers as the capture names them.
        """
        return self._search.carried(mend, self.order, Look(number, q, markers_m))

    def _sudden(self, squared_m2: Array, predicted: Look, last: Look) -> LimbMend | None:
        """The mend of a limb that left its prediction in this frame, though it was seen in the last one.

        Args:
            squared_m2: (M,) squared distances of used markers from their prediction.
            predicted: The frame as it was predicted.
            last: The frame before.
        """
        fits, evidence = self._fits, None
        for k in map(int, np.flatnonzero(fits.worst_segment(squared_m2) > JUMP_M**2)):
            shown = all(self._shows(k, one) for one in (last, *self._looks))
            if predicted.number < self._due.get(k, 0) or not shown:
                continue
            mend = self._search.found(fits.limbs[k], self.order, [predicted], sudden=True)
            if mend is None:
                self._due[k] = predicted.number + self._patience
                continue
            if evidence is None:
                evidence = fits.evidence(predicted.q, named(predicted.markers_m, self.order))
            self._noted(k, predicted.number, evidence)
            return self._mended(k, predicted.number, mend)
        return None

    def _lasting(self, number: int, estimate: Posterior) -> LimbMend | None:
        """The mend of a limb that looks have found in doubt."""
        seen = named(self._looks[-1].markers_m, self.order)
        if not self._open and self._fits.fits_within(
            estimate.q, seen, SURELY * MISFIT_M, SURELY * BEYOND_RAD
        ):
            return None  # as evidence would show, which costs more
        evidence = self._fits.evidence(estimate.q, seen)
        suspects = in_doubt(evidence)
        for k in [k for k in self._open if not suspects[k]]:
            self._close(k, number)
        for k in map(int, np.flatnonzero(suspects)):
            doubt = self._noted(k, number, evidence)
            if number < doubt.due or (doubt.looks < LOOKS_IN_DOUBT and not estimate.started):
                continue
            shown = [one for one in self._looks if self._shows(k, one)]
            mend = self._search.found(self._fits.limbs[k], self.order, [shown[-1], *shown[:-1][:1]])
            if mend is not None:
                return self._mended(k, number, mend)
            doubt.due = number + max(1, round(doubt.patience_s / self._dt_s))
            doubt.patience_s = min(2.0 * doubt.patience_s, MOST_PATIENCE_S)
        return None

    def _shows(self, k: int, look: Look) -> bool:
        """True where enough markers of a limb are seen."""
        seen = ~np.isnan(named(look.markers_m, self.order)[self._fits.on_limb[k], 0])
        return bool(np.count_nonzero(seen) >= LEAST_SEEN)

    def _noted(self, k: int, number: int, evidence: LimbEvidence) -> _Doubt:
        """The limb's doubt with a further look."""
        beyond = evidence.beyond_rad[k] > BEYOND_RAD
        found = LimbDoubt(
            self._fits.limbs[k].name,
            "fits badly" if _misfits(evidence)[k] or not beyond else "beyond its range",
            number * self._dt_s,
            number * self._dt_s,
            self._joint(evidence.dof[k]) if beyond else "",
            float(evidence.beyond_rad[k]),
            float(evidence.misfit_m[k]),
            float(evidence.others_m[k]),
        )
        if k not in self._open:
            self._open[k] = _Doubt(number, 0, 0, PATIENCE_S, found)
        doubt = self._open[k]
        doubt.looks += 1
        if _size(found) > _size(doubt.worst):
            doubt.worst = found
        return doubt

    def _joint(self, dof: int) -> str:
        joints = self._fits.sensor.model.joints.values()
        return next(one.segment for one in joints if one.v.start <= dof < one.v.stop)

    def _close(self, k: int, number: int) -> None:
        """Ends a doubt; a short one of a limb that was not far is forgotten."""
        doubt = self._open.pop(k)
        if self._long(doubt, number) or _size(doubt.worst) > FAR:
            self.doubts.append(self._timed(doubt, number))

    def _long(self, doubt: _Doubt, number: int) -> bool:
        return (number - doubt.since) * self._dt_s > STATED_S

    def _timed(self, doubt: _Doubt, number: int) -> LimbDoubt:
        last = max(number - 1, doubt.since)
        return replace(doubt.worst, from_s=doubt.since * self._dt_s, to_s=last * self._dt_s)

    def _mended(self, k: int, number: int, mend: LimbMend) -> LimbMend:
        """States the doubt that a mend ends, and takes up its names."""
        pairs = self._pairs(mend.order)
        kind: DoubtKind = "names exchanged" if pairs else "turned over"
        found = self._timed(self._open.pop(k), number)
        right_from_s = number * self._dt_s
        self.doubts.append(replace(found, kind=kind, mended=True, exchanged=pairs, right_from_s=right_from_s))
        self.order = mend.order
        self._open.clear()
        self._looks.clear()
        return mend

    def _pairs(self, order: Order | None) -> tuple[tuple[str, str], ...]:
        """Pairs of names that change with an order."""
        if order is None or order is self.order:
            return ()
        names, before = self._fits.names, np.arange(len(order)) if self.order is None else self.order
        changed = np.flatnonzero(order != before)
        pairs = {tuple(sorted((int(m), int(np.flatnonzero(before == order[m])[0])))) for m in changed}
        return tuple((names[a], names[b]) for a, b in sorted(pairs))


def in_doubt(evidence: LimbEvidence) -> NDArray[np.bool_]:
    """(L,) limbs that fit their markers badly, or lie beyond their ranges while enough markers show them."""
    return (evidence.seen >= LEAST_SEEN) & (_misfits(evidence) | (evidence.beyond_rad > BEYOND_RAD))


def _misfits(evidence: LimbEvidence) -> NDArray[np.bool_]:
    return evidence.segment_m > np.maximum(MISFIT_M, TIMES_OTHERS * evidence.others_m)


def _size(doubt: LimbDoubt) -> float:
    return doubt.misfit_m / MISFIT_M + doubt.beyond_rad / BEYOND_RAD
