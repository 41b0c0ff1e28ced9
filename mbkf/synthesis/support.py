"""Supports of the body besides the feet: seats, rails, the floor under a knee or a hand."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from mbkf.conventions import GRAVITY_M_S2, Array
from mbkf.synthesis.contact import FRICTION, NEGLIGIBLE, Load

SEGMENTS = {
    "pelvis": "pelvis",
    "torso": "torso",
    **{
        f"{side}_{part}": f"{side}_{segment}"
        for part, segment in (("hand", "hand"), ("knee", "shank"), ("elbow", "forearm"))
        for side in ("right", "left")
    },
}
"""Segment that takes the wrench, by name of the part of the body that bears."""


@dataclass(frozen=True)
class Support:
    """One part of the body, besides the feet, that bears.

    Attributes:
        name: One of :data:`SEGMENTS`.
        share: (T,) times in s to the part of the whole ground reaction that it takes, 0…1; 0 outside contact.
        point: (T,) times in s to (T, 3) where it presses, m.
        force: (T,) times in s to a further force (T, 3) on the body, N; None: no further force.
        held: Whether the hand holds on, and so may pull.
    """

    name: str
    share: Callable[[Array], Array]
    point: Callable[[Array], Array]
    force: Callable[[Array], Array] | None = None
    held: bool = False

    def shares(self, times: Array) -> Array:
        """(T,) part of the whole ground reaction that it takes, exactly 0 where it comes that close."""
        share = self.share(times)
        return np.where(share < NEGLIGIBLE, 0.0, share)

    def given_force(self, times: Array) -> Array:
        """(T, 3) the part of its force that does not depend on the ground reaction, N."""
        return np.zeros((len(times), 3)) if self.force is None else self.force(times)


def wrenches(supports: Sequence[Support], times: Array, force: Array) -> Array:
    """(T, S, 6) wrenches on the parts that bear, about the world origin: forces at their points.

    Args:
        supports: The parts.
        times: (T,) s.
        force: (T, 3) force of the whole surroundings on the body, N.
    """
    found = np.zeros((len(times), len(supports), 6))
    for k, support in enumerate(supports):
        own = support.shares(times)[:, None] * force + support.given_force(times)
        found[:, k] = np.hstack([own, np.cross(support.point(times), own)])
    return found


def zero_moment(
    supports: Sequence[Support], times: Array, load: Load, height: Array, vertical_n: Array
) -> tuple[Array, Array]:
    """Where the whole ground reaction has no horizontal moment, when feet and supports bear as they should.

    Args:
        supports: The parts that bear besides the feet.
        times: (T,) s.
        load: Planned load of the feet.
        height: (T,) height of the centre of mass, m.
        vertical_n: (T,) vertical force of the whole surroundings on the body.

    Returns:
        (T, 2) the point, m, and (T,) the height at which it lies, m.
    """
    feet, level = load.zero_moment(height), load.mean_surface
    shares = [support.shares(times) for support in supports]
    rest = 1.0 - sum(shares, start=np.zeros(len(times)))
    point, mean_level = rest[:, None] * feet, rest * level
    safe = np.maximum(vertical_n, 1e-3 * vertical_n.max())[:, None]
    for support, share in zip(supports, shares, strict=True):
        at, force = support.point(times), support.given_force(times)
        point = point + share[:, None] * at[:, :2]
        mean_level = mean_level + share * at[:, 2]
        lever = (at[:, :2] - feet) * force[:, 2:] - (at[:, 2] - level)[:, None] * force[:, :2]
        point = point + lever / safe
    return point, mean_level


def fault(supports: Sequence[Support], found: Array) -> str:
    """A sentence on the broken law of contact, "" where all hold: an unheld part only pushes, and does not slip.

    Args:
        supports: The parts that bear.
        found: (T, S, 6) their wrenches.
    """
    for support, wrench in zip(supports, np.moveaxis(found, 1, 0), strict=True):
        along = np.linalg.norm(wrench[:, :2], axis=1)
        name = support.name.replace("_", " ")
        if support.held:
            continue
        if wrench[:, 2].min() < 0:
            return f"the {name} would be pulled"
        if (along > FRICTION * wrench[:, 2] + 1e-9).any():
            return f"the {name} would slip"
    return ""


def weight_n(mass_kg: float, lift: Array) -> Array:
    """(T,) vertical force of the surroundings on a body whose centre of mass accelerates upwards.

    Args:
        mass_kg: Mass of the body.
        lift: (T,) upward acceleration, m/s².
    """
    return np.asarray(mass_kg * (GRAVITY_M_S2 + lift))
