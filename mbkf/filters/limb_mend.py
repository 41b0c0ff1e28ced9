"""A limb set right in a filter's state: its pose and velocity are new, and nothing of the rest depends on them yet."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array
from mbkf.filters.plant import StateT
from mbkf.model.body import Body
from mbkf.model.layout import Layout
from mbkf.sensors.limb_starts import Order

POSE_SD_RAD, VELOCITY_SD_RAD_S = 0.1, 5.0
"""Spreads of a fitted limb's pose and of its velocity between two fits, before the filter reads its markers."""


@dataclass(frozen=True)
class LimbMend:
    """A better pose of a limb, or of both limbs whose names were exchanged.

    Attributes:
        q: (nq,) configuration with the limb in its new pose.
        v: (n,) velocity of its dofs, rad/s; None: as predicted.
        dofs: (n,) the dofs.
        order: (M,) place in the capture of each marker that the filter reads from here on; None: the capture's own.
    """

    q: Array
    v: Array | None
    dofs: NDArray[np.intp]
    order: Order | None = None


def with_limb(model: Body, state: StateT, layout: Layout, mend: LimbMend) -> StateT:
    """A predicted state whose limb has the new pose, uncorrelated with the rest.

    Args:
        model: The body.
        state: The state, with parts q, v and, where the filter has them, accelerations.
        layout: Its layout.
        mend: The limb.
    """
    dofs = mend.dofs
    step = np.zeros(model.nv)
    step[dofs] = model.difference(state.q, mend.q)[dofs]
    v = state.v.copy()
    if mend.v is not None:
        v[dofs] = mend.v
    spreads = {"q": POSE_SD_RAD, "v": VELOCITY_SD_RAD_S}
    changed: dict[str, Array] = {"q": model.integrate(state.q, step), "v": v}
    P = np.array(state.P, order="F")
    for name in ("q", "v", "a"):
        if name not in layout:
            continue
        own = layout[name].start + dofs
        P[own, :] = P[:, own] = 0.0
        P[own, own] = model.acceleration_sd[dofs] ** 2 if name == "a" else spreads[name] ** 2
    if "a" in layout:
        a = state.a.copy()  # type: ignore[attr-defined]
        a[dofs] = 0.0
        changed["a"] = a
    return replace(state, **changed, P=P)  # type: ignore[type-var]
