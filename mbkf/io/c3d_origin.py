"""The sign of a force plate's ORIGIN, which files store either way: by where transducers and pressure can be.

ORIGIN leads from the point the channels refer to, O, to the centre of the surface, S, in plate axes, whose z points
down. Transducers lie below the surface, so its z is negative; where it is positive, makers' sheets gave S → O or the
depth, and all of it is turned, as Visual3D does. A wrong sign moves the centre of pressure by 2 h F_shear / F_normal
with the depth h. Where the plate is long and O lies beside its middle (treadmills, z = 0), the sign of x and y is
that with which the pressure lies on the plate.

Sources: The C3D File Format, FORCE_PLATFORM:ORIGIN and its types (c3d.org); Visual3D's documentation of FP_ORIGIN.
"""

from __future__ import annotations

import numpy as np

from mbkf.conventions import Array

LOADED_N, LEAST_LOADED = 100.0, 20
"""Load from which a sample shows its point of pressure, and number of samples that decide."""

BESIDE_M = 0.05
"""Distance beside a plate at which errors may place a pressure, and of O from its middle that calls for a remark."""

MOSTLY, SELDOM = 0.9, 0.1
"""Shares of samples that press on the plate."""

DEEPEST_M = 0.5
"""Thickness of the thickest plates."""


def turned_by_depth(stored_m: Array, name: str, notes: list[str]) -> Array:
    """(3,) the vector O → S in plate axes, m, with its transducers below the surface: z ≤ 0.

    Args:
        stored_m: (3,) ORIGIN of the file, m.
        name: The plate, for remarks.
        notes: Receives the remark that it was turned, or that no plate is that thick.
    """
    depth_m = float(abs(stored_m[2]))
    if depth_m > DEEPEST_M:
        notes.append(f"{name}: ORIGIN puts its transducers {depth_m:g} m below the surface; check its unit")
    if not stored_m[2] > 0.0:
        return stored_m
    notes.append(
        f"{name}: ORIGIN puts its transducers {1e3 * depth_m:.3g} mm above the surface; "
        "it is taken with the opposite sign"
    )
    return -stored_m


def turned_by_pressure(
    origin_m: Array, force: Array, moment: Array, half_sides_m: Array, name: str, notes: list[str]
) -> Array:
    """(3,) the vector O → S, m, with the sign of x and y that puts the pressure onto the plate, if loads decide it.

    Args:
        origin_m: (3,) the vector O → S of the file, m.
        force: (S, 3) N, plate axes.
        moment: (S, 3) N m about O.
        half_sides_m: (2,) half the plate's sides.
        name: The plate, for remarks.
        notes: Receives the remark that it was turned.
    """
    loaded = np.abs(force[:, 2]) > LOADED_N
    if np.abs(origin_m[:2]).max() < BESIDE_M or np.count_nonzero(loaded) < LEAST_LOADED:
        return origin_m
    other_m = origin_m * [-1.0, -1.0, 1.0]

    def share(vector_m: Array) -> float:
        return share_on_plate(force[loaded], moment[loaded] + np.cross(force[loaded], vector_m), half_sides_m)

    if share(origin_m) < SELDOM and share(other_m) > MOSTLY:
        notes.append(
            f"{name}: x and y of ORIGIN are taken with the opposite sign, since the pressure is then on it"
        )
        return other_m
    return origin_m


def pressed_m(force: Array, moment: Array) -> Array:
    """(S, 2) points of pressure, x and y in plate axes, m, of forces (S, 3) N and moments (S, 3) N m.

    Moments are about the middle of the surface.
    """
    place: Array = np.column_stack([-moment[:, 1], moment[:, 0]]) / force[:, 2:]
    return place


def share_on_plate(force: Array, moment: Array, half_sides_m: Array) -> float:
    """Share of the samples that press on the plate or within :data:`BESIDE_M` of it.

    Args:
        force: (S, 3) N, with a normal part.
        moment: (S, 3) about the middle of the surface, N m.
        half_sides_m: (2,) half the plate's sides.
    """
    return float((np.abs(pressed_m(force, moment)) < half_sides_m + BESIDE_M).all(axis=1).mean())
