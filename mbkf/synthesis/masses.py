"""Masses of a body's segments: the first moment of mass of segments that move, and the rates of the second."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array
from mbkf.model.body import Body
from mbkf.synthesis import dual_numbers
from mbkf.synthesis.dual_numbers import Dual


@dataclass(frozen=True)
class MovingMass:
    """Sums over moving segments, about an origin.

    Attributes:
        moment: (T, 3) first moment of mass ∫ x dm, kg m.
        second: (n - 1, T, 3, 3) ∫ ẋ xᵀ dm and, where accelerations are known, ∫ ẍ xᵀ dm, kg m²/s and kg m²/s². Twice
            their axial vectors are the angular momentum and its derivative.
    """

    moment: Dual
    second: Array


class Masses:
    """Masses of one scaled body.

    Attributes:
        kg: Mass by segment.
        com: (3,) centre of mass by segment, m.
        moments: (3, 3) second moments of mass about the centre of mass by segment, kg m².
    """

    def __init__(self, model: Body) -> None:
        self.kg: dict[str, float] = {}
        self.com: dict[str, Array] = {}
        self.moments: dict[str, Array] = {}
        for segment in model.description.segments:
            inertia = model.pin_model.inertias[model.joint(segment.name).joint_id]
            about_com = np.array(inertia.inertia)
            self.kg[segment.name] = float(inertia.mass)
            self.com[segment.name] = np.array(inertia.lever)
            self.moments[segment.name] = 0.5 * np.trace(about_com) * np.eye(3) - about_com

    def moving(self, rotations: Mapping[str, Dual], origins: Mapping[str, Dual]) -> MovingMass:
        """The moving mass of the segments that have an origin.

        Args:
            rotations: By segment, its (T, 3, 3) rotation.
            origins: By segment, the (T, 3) origin of its frame, m.
        """
        mass = np.array([self.kg[name] for name in origins])
        moments = np.array([self.moments[name] for name in origins])
        centres = [origin + rotations[name].apply(self.com[name]) for name, origin in origins.items()]
        at = dual_numbers.stack(centres).orders
        turned = dual_numbers.stack([rotations[name] for name in origins]).orders[: len(at)]
        turned_moments = np.einsum("sij,tkjs->tiks", moments, turned[0])
        second = np.einsum("ntijs,tjks->ntik", turned[1:], turned_moments)
        second += np.einsum("ntis,tks->ntik", at[1:], mass * at[0])
        return MovingMass(Dual.of(at @ mass), second)
