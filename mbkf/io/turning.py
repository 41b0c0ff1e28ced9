"""A capture turned or mirrored into other axes: markers, plates, and the forces and moments they read."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import ShapeError
from mbkf.io.axes import axes_matrix, axes_text
from mbkf.io.plate_corners import plate_normal, upward_normal
from mbkf.io.records import AxesSource, Capture, PlateReadings
from mbkf.io.wrench import centre_of_pressure, find_tare, remove_tare

_UP = np.array([0.0, 0.0, 1.0])


def turned(capture: Capture, turn: Array, source: AxesSource) -> Capture:
    """The capture as it would be, had its file been read with other axes.

    Derived points and analog channels stay as they are, in the file's axes. The capture's ``axes`` are the new ones.

    Args:
        capture: The capture.
        turn: (3, 3) signed permutation Q, ``p_new = Q @ p_old``; determinant −1 for a reflection.
        source: Where the new axes are known from.

    Raises:
        ShapeError: ``turn`` is not a signed permutation.
    """
    if turn.shape != (3, 3) or not np.array_equal(turn @ turn.T, np.eye(3)) or (np.abs(turn) % 1).any():
        raise ShapeError("turn", "(3, 3), a signed permutation", turn.shape)
    axes = axes_text(turn @ axes_matrix(capture.axes))
    markers = replace(capture.markers, positions_m=capture.markers.positions_m @ turn.T)
    others = capture.others
    if others is not None:
        others = replace(others, positions_m=others.positions_m @ turn.T)
    return replace(
        capture,
        markers=markers,
        others=others,
        plates=tuple(turned_plate(plate, turn) for plate in capture.plates),
        axes=axes,
        up_axis=axes.split(",")[2],
        axes_source=source,
    )


def turned_plate(plate: PlateReadings, turn: Array) -> PlateReadings:
    """A plate in other axes.

    A force turns as a vector, p → Q p, with the signed permutation Q = ``turn`` (3, 3). A moment r × F is a
    pseudovector, M → det(Q) Q M, so that it keeps the sense in which the force turns about the origin. A plate with
    corners reads in axes of its own, which are right-handed whatever the file does: where Q mirrors the corners, their
    order makes the plate's normal n face the other way, and its readings turn by the proper rotation Q (1 − 2 n nᵀ).
    """
    wrench_turn = turn
    if plate.corners_m is not None and np.linalg.det(turn) < 0.0:
        normal = plate_normal(plate.corners_m)
        wrench_turn = turn @ (np.eye(3) - 2.0 * np.outer(normal, normal))
    moved = rotated(plate, turn, wrench_turn)
    return moved if np.allclose(wrench_turn[2], _UP) else _pressed_anew(_tared_anew(moved))


def rotated(plate: PlateReadings, turn: Array, wrench_turn: Array) -> PlateReadings:
    """A plate in other axes, with the offset and the centres of pressure that it has.

    Args:
        plate: The plate.
        turn: (3, 3) matrix of its points.
        wrench_turn: (3, 3) matrix of its forces.
    """
    moment_turn = wrench_turn if np.linalg.det(wrench_turn) > 0.0 else -wrench_turn
    return replace(
        plate,
        origin_m=turn @ plate.origin_m,
        force_n=plate.force_n @ wrench_turn.T,
        moment_nm=plate.moment_nm @ moment_turn.T,
        centre_of_pressure_m=plate.centre_of_pressure_m @ turn.T,
        corners_m=None if plate.corners_m is None else plate.corners_m @ turn.T,
        offset=np.concatenate([wrench_turn @ plate.offset[:3], moment_turn @ plate.offset[3:]]),
    )


def recentred(plate: PlateReadings) -> PlateReadings:
    """A plate without corners with its moments about the mean centre of pressure, as its reader gives them.

    Where the reader took another axis for the vertical, it could not find that point.
    """
    pressed = plate.centre_of_pressure_m[~np.isnan(plate.centre_of_pressure_m).any(axis=1)]
    if plate.corners_m is not None or not len(pressed):
        return plate
    origin = pressed.mean(axis=0)
    moment = plate.moment_nm + np.cross(plate.origin_m - origin, plate.force_n)
    return replace(plate, origin_m=origin, moment_nm=moment)


def _tared_anew(plate: PlateReadings) -> PlateReadings:
    """The plate with its offset removed along the new vertical, if one was removed before."""
    if not plate.offset.any():
        return plate
    wrench = np.hstack([plate.force_n, plate.moment_nm])
    zeroed = (wrench == 0.0).all(axis=1)
    raw = np.where(zeroed[:, None], 0.0, wrench + plate.offset)
    found = find_tare(raw, plate.rate_hz)
    wrench = remove_tare(raw, found)
    return replace(plate, force_n=wrench[:, :3], moment_nm=wrench[:, 3:], offset=found.offset)


def _pressed_anew(plate: PlateReadings) -> PlateReadings:
    """The plate with its centre of pressure found for the new vertical, in the surface or at its origin's height."""
    normal = _UP if plate.corners_m is None else upward_normal(plate.corners_m)
    pressure = centre_of_pressure(plate.force_n, plate.moment_nm, plate.origin_m, normal, plate.threshold_n)
    return replace(plate, centre_of_pressure_m=pressure)
