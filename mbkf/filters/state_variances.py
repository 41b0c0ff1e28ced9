"""Variances of all that is read off one frame of the dynamic filter, worked out together."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array
from mbkf.filters.error_covariance import ErrorCovariance
from mbkf.kernel.loading import library


class StateVariances(NamedTuple):
    """By the filter; b blocks of three dofs each.

    Attributes:
        position: (nv,) of the configuration in its tangent space.
        velocity: (nv,) of the velocity.
        wrench: (12,) of the feet's wrenches.
        torque: (m,) of quantities of the whole state.
        height: (l,) of quantities of the configuration.
        blocks: (b, 3, 3) covariances of the configuration.
    """

    position: Array
    velocity: Array
    wrench: Array
    torque: Array
    height: Array
    blocks: Array


def state_variances(
    errors: ErrorCovariance, by_state: Array, by_position: Array, dofs: NDArray[np.intp]
) -> StateVariances:
    """Variances of a state's errors, by the compiled kernel where there is one.

    Args:
        errors: The errors.
        by_state: (m, n) derivative of quantities by the state's first n components, feet's wrenches among them.
        by_position: (l, nv) derivative of others by the configuration.
        dofs: (b, 3) dofs of each block, one after the other.

    Raises:
        numpy.linalg.LinAlgError: A frame does not determine the joints that its markers observe.
    """
    found = _compiled(errors, by_state, by_position, dofs)
    if found is not None:
        return found
    position = errors.position
    return StateVariances(
        errors.position_variance,
        errors.velocity_variance,
        errors.wrench_variance,
        errors.variance_of(by_state),
        ((by_position @ position) * by_position).sum(axis=1),
        position[dofs[:, :, None], dofs[:, None, :]],
    )


def _compiled(
    errors: ErrorCovariance, by_state: Array, by_position: Array, dofs: NDArray[np.intp]
) -> StateVariances | None:
    """By the kernel; None where there is none, or where it cannot factorise the information.

    Args:
        errors: The errors.
        by_state: (m, n) derivative of quantities by the state's first n components.
        by_position: (l, nv) derivative of others by the configuration.
        dofs: (b, 3) dofs of each block.
    """
    kernel = library()
    if kernel is None:
        return None
    layout = errors.layout
    failed, diagonal, torque, height, blocks = kernel.error_variances(
        errors.P,
        np.ascontiguousarray(errors.information),
        np.asarray(errors.seen, np.int32),
        errors.size,
        errors.skin,
        errors.rate_rad_s,
        errors.apart,
        errors.added,
        np.asfortranarray(by_state),
        np.asfortranarray(by_position),
        dofs[:, 0].astype(np.int32),
    )
    if failed:
        return None
    wrench = diagonal[layout.wrench]
    return StateVariances(diagonal[layout.q], diagonal[layout.v], wrench, torque, height, blocks)
