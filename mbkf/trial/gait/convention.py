"""Conventions of curves: the axes, signs and order in which a laboratory reads the motion of a body.

``model`` leaves a result as it is. ``isb`` reads angles in the ISB's axes, with the body's own signs. ``clinical`` is
that of gait laboratories (M. P. Kadaba et al., J. Orthop. Res. 8 (1990) 383-392; R. B. Davis et al., Hum. Mov. Sci. 10
(1991) 575-587): Plug-in Gait's axes and zero, the pelvis tilted forward and the side's own half of it up and forward
are positive, pelvis, trunk and feet are read in the direction of progression, and moments of the legs are positive in
extension, abduction and outward rotation. That is the internal moment; the external one that it balances, positive in
flexion, is the same number under another name.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from mbkf.errors import UnknownName
from mbkf.io.results import Reconstruction

CLINICAL, ISB, MODEL = "clinical", "isb", "model"
CONVENTIONS = (CLINICAL, ISB, MODEL)
"""Names of the conventions."""

INTERNAL, EXTERNAL = "internal", "external"
MOMENTS = (INTERNAL, EXTERNAL)
"""Names under which moments are shown."""

FOOT_PROGRESSION = "foot_progression"
TRUNK = ("trunk_tilt", "trunk_obliquity", "trunk_rotation")
"""Curves besides the body's coordinates: of feet and trunk, in the direction of progression."""


@dataclass(frozen=True)
class Convention:
    """A convention.

    Attributes:
        name: "clinical", "isb" or "model".
        axes: Axes that angles are read in, as :mod:`mbkf.trial.results.readings` names them; empty for those of the
            result.
        reversed_angles: Coordinates whose sign is the body's reversed, as the right side sees them.
        reversed_moments: Coordinates whose moments are positive against their angles.
        walking: Whether feet and trunk are read in the direction of progression, as the pelvis.
        rows: Angles in the order of charts; empty for the body's own.
        moments: "internal", or "external" for the name of the load that an internal moment balances.
    """

    name: str
    axes: str = ""
    reversed_angles: frozenset[str] = frozenset()
    reversed_moments: frozenset[str] = frozenset()
    walking: bool = False
    rows: tuple[tuple[str, ...], ...] = ()
    moments: str = INTERNAL

    def angle_sign(self, name: str) -> float:
        """Factor from the body's coordinate, named without its side, to the convention's angle."""
        return -1.0 if name in self.reversed_angles else 1.0

    def moment_sign(self, name: str) -> float:
        """Factor from the moment conjugate to the body's coordinate to the convention's moment."""
        return -1.0 if name in self.reversed_moments else 1.0


BY_MODEL = Convention(MODEL)
"""Angles and moments as the result holds them."""

BY_ISB = Convention(ISB, "isb")

BY_CLINIC = Convention(
    CLINICAL,
    "pig",
    frozenset({"pelvis_tilt", "pelvis_list"}),
    frozenset(
        {
            "hip_flexion",
            "hip_adduction",
            "hip_rotation",
            "knee_angle",
            "knee_adduction",
            "knee_rotation",
            "ankle_angle",
            "subtalar_angle",
            "ankle_rotation",
        }
    ),
    walking=True,
    rows=(
        ("pelvis_tilt", "pelvis_list", "pelvis_rotation"),
        ("hip_flexion", "hip_adduction", "hip_rotation"),
        ("knee_angle", "knee_adduction", "knee_rotation"),
        ("ankle_angle", "ankle_rotation", FOOT_PROGRESSION),
        TRUNK,
    ),
)


def convention_of(name: str, moments: str = INTERNAL) -> Convention:
    """The convention of a name.

    Args:
        name: One of :data:`CONVENTIONS`.
        moments: One of :data:`MOMENTS`, for the clinical convention.

    Raises:
        UnknownName: One of them does not exist.
    """
    known = {one.name: one for one in (BY_CLINIC, BY_ISB, BY_MODEL)}
    if name not in known:
        raise UnknownName("convention", name, CONVENTIONS)
    if moments not in MOMENTS:
        raise UnknownName("kind of moments", moments, MOMENTS)
    return replace(known[name], moments=moments)


def convention_of_result(r: Reconstruction) -> Convention:
    """The convention that a result was reconstructed with; the body's own for results that state no other."""
    return convention_of(str(r.settings.get("convention", MODEL)))
