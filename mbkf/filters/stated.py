"""What the dynamic filter says of its errors, where skin repeats them from frame to frame.

Its marker noise is wide, because a frame of skin-borne markers is no independent reading, and its plant as wide to
keep up; gains depend on their ratio, but P on their size. So P is not what the errors are like. They have two parts:

    what is new in every frame    κ P, κ the share of the marker noise that is new
    what skin repeats             C of positions and, moving about as ω, ω² C of velocities, ω⁴ C of accelerations

with C the covariance of a pose fitted to one frame whose markers err as much as the innovations show; a sine of
amplitude 1 has q, v and a of size 1, ω and −ω², the first and the last in opposition. Joints that nobody sees owe
their spread to neither, and wrenches theirs to plates: they keep what P says.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array


def stated_covariance(
    P: Array, information: Array, unknown: NDArray[np.intp], skin: float, new: float, rate_rad_s: float
) -> Array:
    """(N, N) covariance of the errors of (q, v, a, w), positive semidefinite as P is.

    Args:
        P: (3 nv + 12, 3 nv + 12) the filter's.
        information: (nv, nv) of one frame on the configuration, as the filter weighs it.
        unknown: Dofs that nobody sees.
        skin: Variance of the markers over what the filter takes for it.
        new: Share κ of what the filter takes for it that is new in every frame.
        rate_rad_s: ω.
    """
    nv = len(information)
    seen = np.ones(nv, dtype=bool)
    seen[unknown] = False
    size = np.ones(len(P))
    size[: 3 * nv] = np.tile(np.where(seen, new**0.5, 1.0), 3)
    stated = P * size * size[:, None]
    where = np.flatnonzero(seen)
    C = skin * np.linalg.inv(information[np.ix_(where, where)])
    rates = (1.0, rate_rad_s, rate_rad_s**2)
    for first, second, sign in ((0, 0, 1.0), (1, 1, 1.0), (2, 2, 1.0), (0, 2, -1.0), (2, 0, -1.0)):
        stated[np.ix_(first * nv + where, second * nv + where)] += sign * rates[first] * rates[second] * C
    return stated
