"""Whether an estimate is a person: finite, no faster than bodies move, on the ground with no more than bodies bear.

Readings that contradict each other (a plate in other units, of another person, of another time) may drive a filter or a
smoother to numbers that solve its equations and are no motion. Newton's law is not linear: a smoother, which follows
linearisations back in time, leaves the person earlier and further than the filter does.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from mbkf.conventions import GRAVITY_M_S2
from mbkf.filters.estimate import Posterior
from mbkf.model.body import Body
from mbkf.sensors.contact.possible import MOST_WEIGHTS
from mbkf.sensors.gating import TRACK_LOSS_M

MOST_RAD_S = 300.0
"""No joint turns faster, rad/s. The fastest that is known, the shoulder of a pitcher, reaches 126 in the mean of
professionals (Fleisig 1999: 7,240°/s)."""

DOUBT = 2.0
"""An estimated force may exceed the largest known one, :data:`mbkf.sensors.contact.possible.MOST_WEIGHTS`, by this."""


def is_person(estimate: Posterior, model: Body) -> bool:
    """Whether an estimate's numbers are those of a moving person.

    Args:
        estimate: The estimate.
        model: The body.
    """
    if not (np.isfinite(estimate.q).all() and np.isfinite(estimate.a).all()):
        return False
    if not np.abs(estimate.v).max(initial=0.0) <= MOST_RAD_S:  # NaN is not
        return False
    most = DOUBT * MOST_WEIGHTS * GRAVITY_M_S2 * model.mass_kg
    return not (np.abs(estimate.wrench[:, :3]) > most).any()


def departed(causal: Posterior, corrected: Posterior, model: Body) -> bool:
    """Whether later frames move most joints further than a track may be off, though markers showed the body at once.

    Args:
        causal: The filter's own estimate.
        corrected: The same in the light of later frames.
        model: The body.
    """
    if not (causal.tracked and causal.placed) or causal.started:
        return False
    places = (model.placements(one.q)[1] for one in (causal, corrected))
    moved = np.linalg.norm(np.subtract(*places), axis=1)
    return bool(2 * np.count_nonzero(moved > TRACK_LOSS_M) > len(moved))


def corrected_or_own(
    own: Sequence[Posterior], correct: Callable[[], Sequence[Posterior]], model: Body
) -> list[Posterior]:
    """Estimates in the light of later frames; the filter's own, marked as such, where one of those is no person.

    Args:
        own: The filter's estimates.
        correct: Makes the corrected ones, as many.
        model: The body.
    """
    try:
        with np.errstate(all="ignore"):  # what comes of it is looked at
            found = list(correct())
            pairs = zip(own, found, strict=True)
            if all(is_person(b, model) and not departed(a, b, model) for a, b in pairs):
                return found
    except np.linalg.LinAlgError:
        pass
    return [one._replace(uncorrected=True) for one in own]
